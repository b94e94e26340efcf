#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/process/child_process.hpp"
#include "core/process/json_lines.hpp"
#include "core/process/process_options.hpp"
#include "core/support/json.hpp"

namespace evbench::process {

/// Version of the protocol (docs/reference/process_protocol.md). Both sides send it first; it must be the same.
inline constexpr int kVersion = 1;

/// evbench's side of the protocol with a process, in lock-step: one line out, one line back. Every failure is a
/// ProcessError whose sentence names the process, the failure, the last message and the last lines of its standard
/// error. The process is then killed, and every further call throws the same error.
class Dialogue {
 public:
  /// Starts the process in options.folder. `place` is the place of the options for messages, `folder` the base of their
  /// relative paths. Throws InputError for invalid options.
  Dialogue(const ProcessOptions& options, const std::string& place, const std::string& folder);

  /// A process that has answered finish() gets a second to end.
  ~Dialogue();

  /// Sends `line`, a JSON object, and returns read(answer) of the answer, a JSON object. `read` throws MessageError for
  /// an invalid answer. `about` names the message in errors: "the batch until 0.3 s".
  template <class Read>
  auto ask(Line& line, const std::string& about, Read read) {
    try {
      const Json answer = parse_object(send(line));
      if (const Json* error = find(answer, "error")) refuse(*error);
      return read(answer);
    } catch (const ProcessError& error) {
      fail(error.what(), about);
    } catch (const MessageError& error) {
      fail(std::string("answered wrongly: ") + error.what(), about);
    }
  }

  /// The first exchange: sends `greeting` with the version; the answer must have the same version. The answer may have
  /// the keys "evbench", "name" and `keys`.
  Json open(Json greeting, std::initializer_list<std::string> keys = {});

  /// The name that the process gave itself; without one, the command.
  const std::string& name() const { return name_; }

  /// The last exchange: {"finish": true}.
  template <class Read>
  auto finish(Read read) {
    Line line;
    fmt::format_to(std::back_inserter(line), "{{\"finish\":true}}");
    finished_ = true;
    return ask(line, "the finish message", read);
  }

  /// The last lines of its standard error, for the log; empty when there are none.
  std::string errors() const;

 private:
  std::string send(Line& line);
  [[noreturn]] static void refuse(const Json& error);
  [[noreturn]] void fail(const std::string& what, const std::string& about);

  std::string place_, command_, name_;
  double timeout_;
  std::unique_ptr<ChildProcess> process_;
  bool finished_ = false;
  std::string failure_;
};

}  // namespace evbench::process
