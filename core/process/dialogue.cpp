#include "core/process/dialogue.hpp"

#include <vector>

#include "core/io/path.hpp"
#include "core/support/json.hpp"

namespace evbench::process {

namespace {
constexpr double kEndGrace = 1.0;  ///< [s] for a process to end after its last answer
}

Dialogue::Dialogue(const ProcessOptions& options, const std::string& place, const std::string& folder)
    : place_(place), command_(command_text(options.command)), name_(command_), timeout_(options.timeout) {
  const std::vector<std::string> words = command_words(options.command, place);
  try {
    process_ = std::make_unique<ChildProcess>(words, resolve_path(options.folder, folder));
  } catch (const ProcessError& error) {
    throw ProcessError(fmt::format("{}: the process \"{}\" {}", place_, command_, error.what()));
  }
}

Dialogue::~Dialogue() {
  if (finished_ && failure_.empty()) process_->close(kEndGrace);
}

std::string Dialogue::send(Line& line) {
  if (!failure_.empty()) throw ProcessError(failure_);
  line.push_back('\n');
  return process_->exchange({line.data(), line.size()}, timeout_);
}

void Dialogue::refuse(const Json& error) {
  throw ProcessError("reports an error: " + printable(text(error, {"error"}), 1000));
}

void Dialogue::fail(const std::string& what, const std::string& about) {
  if (failure_.empty()) {
    failure_ = fmt::format("{}: the process \"{}\" {}; last message to it: {}", place_, command_, what, about);
    const std::string last = errors();
    failure_ +=
        last.empty() ? "; it wrote nothing to its standard error" : "; the last lines of its standard error:" + last;
    process_->kill();
  }
  throw ProcessError(failure_);
}

Json Dialogue::open(Json greeting, std::initializer_list<std::string> keys) {
  Json complete = {{"evbench", kVersion}};
  complete.update(greeting);
  Line line;
  const std::string text_of_it = dump_json(complete);
  line.append(text_of_it);
  return ask(line, "the opening message", [&](const Json& answer) {
    const Json& version = require(answer, "evbench");
    if (version != kVersion) {
      throw MessageError(fmt::format("evbench: it speaks version {} of the protocol; expected {}",
                                     printable(dump_json(version), 40), kVersion));
    }
    std::vector<std::string> known = {"evbench", "name"};
    known.insert(known.end(), keys);
    check_keys(answer, known);
    if (const Json* name = find(answer, "name")) name_ = printable(text(*name, {"name"}), 200);
    return answer;
  });
}

std::string Dialogue::errors() const { return process_->errors().empty() ? "" : process_->errors().text("  "); }

}  // namespace evbench::process
