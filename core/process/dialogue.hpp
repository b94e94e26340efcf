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

/// The version of protocol.md: told by both sides before all else, and the same.
inline constexpr int kVersion = 1;

/// evbench's side of a dialogue with a process, in lock-step: a line is told, a line answers. Whatever goes wrong is a
/// ProcessError whose sentence names the process, what it was told, what went wrong, and the last lines of its standard
/// error; the process is then killed, and asking again throws the same.
class Dialogue {
 public:
  /// Starts the process in options.folder. `place` is where the options stand, `folder` what they are relative to.
  /// Throws InputError for options that make no sense.
  Dialogue(const ProcessOptions& options, const std::string& place, const std::string& folder);

  /// A process that has been asked to finish has a second to end.
  ~Dialogue();

  /// Tells `line`, a JSON object; read(answer) makes of the answer, a JSON object, what is returned, and throws
  /// MessageError for one that makes no sense. `about` says in messages what was told: "the batch until 0.3 s".
  template <class Read>
  auto ask(Line& line, const std::string& about, Read read) {
    try {
      const Json answer = parse_object(tell(line));
      if (const Json* error = find(answer, "error")) refuse(*error);
      return read(answer);
    } catch (const ProcessError& error) {
      fail(error.what(), about);
    } catch (const MessageError& error) {
      fail(std::string("answered wrongly: ") + error.what(), about);
    }
  }

  /// The first exchange: `greeting` is completed with the version; the answer must have the same. Of the answer, `keys`
  /// may be there besides "evbench" and "name".
  Json open(Json greeting, std::initializer_list<std::string> keys = {});

  /// The process' own name, the command's text where it has told none.
  const std::string& name() const { return name_; }

  /// The last exchange: {"finish": true}.
  template <class Read>
  auto finish(Read read) {
    Line line;
    fmt::format_to(std::back_inserter(line), "{{\"finish\":true}}");
    finished_ = true;
    return ask(line, "that this is the end", read);
  }

  /// The last lines of its standard error, for a log; empty when there are none.
  std::string errors() const;

 private:
  std::string tell(Line& line);
  [[noreturn]] static void refuse(const Json& error);
  [[noreturn]] void fail(const std::string& what, const std::string& about);

  std::string place_, command_, name_;
  double timeout_;
  std::unique_ptr<ChildProcess> process_;
  bool finished_ = false;
  std::string failure_;
};

}  // namespace evbench::process
