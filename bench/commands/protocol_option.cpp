#include "bench/commands/protocol_option.hpp"

#include "bench/commands/name_check.hpp"
#include "eval/protocols.hpp"

namespace evbench {

CLI::Option* add_protocol_name(CLI::App& command, std::string& protocol, const std::string& text) {
  std::vector<std::string> names = protocol_choices();
  std::erase(names, "none");
  return command.add_option("--protocol", protocol, text)->check(one_of(names));
}

}  // namespace evbench
