#include "bench/commands/causal_flag.hpp"

#include <fmt/format.h>

namespace evbench {

void add_causal_flag(CLI::App& command, bool& causal, const std::string& text) {
  command.add_flag("--causal", causal, text);
  const auto old = [&causal] {
    causal = true;
    fmt::print(stderr, "--online is called --causal now; the old name is read until the next version\n");
  };
  command.add_flag_callback("--online", old)->group("");  // not in the help
}

}  // namespace evbench
