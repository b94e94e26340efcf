#include <sstream>

#include "bench/testing/program.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The completions of bash for the last of these words.
std::set<std::string> offered(const TemporaryFolder& folder, const std::string& words) {
  const Outcome outcome = shell(folder, "bash -c 'source completion && COMP_WORDS=(" + words +
                                            ") && COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) && $(complete -p evbench | sed "
                                            "\"s/.*-F \\([^ ]*\\) .*/\\1/\") && printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
  INFO(words << ": " << outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  std::istringstream lines(outcome.out);
  std::set<std::string> result;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) result.insert(line);
  }
  return result;
}

}  // namespace

TEST_CASE("Bash completes commands, options, and values that are one of a few names", "[slow]") {
  const TemporaryFolder folder;
  REQUIRE(shell(folder, "\"$evbench\" completion bash > completion && bash -n completion").exit_code == 0);
  using Names = std::set<std::string>;
  const auto offers = [&](const std::string& words) { return offered(folder, words); };
  CHECK(offers("evbench sw") == Names{"sweep"});
  CHECK(offers("evbench \"\"").contains("check-plugin"));
  CHECK(offers("evbench dataset \"\"") == Names{"get", "list", "verify"});
  CHECK(offers("evbench help sta") == Names{"status"});
  CHECK(offers("evbench run --fo") == Names{"--force"});
  CHECK(offers("evbench run c.json --out --fo").empty());  // the folder's name
  CHECK(offers("evbench run --out o c.json --fo") == Names{"--force"});
  CHECK(offers("evbench --plugin run ev") == Names{"eval", "eval-tracks"});
  CHECK(offers("evbench run --plugin p --fo") == Names{"--force"});
  CHECK(offers("evbench run c.j").empty());  // a file
  const Names formats = offers("evbench table results --format \"\"");
  CHECK(formats.contains("latex"));
  CHECK(offers("evbench table results --format =") == formats);
  CHECK(offers("evbench table results --format = la") == Names{"latex"});
  CHECK(offers("evbench figure traj") == Names{"trajectory"});
  CHECK(offers("evbench figure box traj").empty());
  CHECK(offers("evbench sweep --vary seed = 1..3 --dry") == Names{"--dry-run"});
}

TEST_CASE("Completion for zsh offers the same as for bash") {
  const TemporaryFolder folder;
  const std::string bash = testing::evbench(folder, "completion bash").out,
                    zsh = testing::evbench(folder, "completion zsh").out;
  CHECK(zsh.starts_with("#compdef evbench\n"));
  const auto tables = [](const std::string& script) {
    const std::size_t from = script.find("_evbench_is_command()");
    return script.substr(from, script.find("\n_evbench() {") - from);
  };
  CHECK(tables(bash).size() > 2000);
  CHECK(tables(bash) == tables(zsh));
  CHECK_THAT(testing::evbench(folder, "completion fish").err, ContainsSubstring("\"fish\" is none of its names"));
}

TEST_CASE("The manual page has every command and option, and man prints no warning", "[slow]") {
  const TemporaryFolder folder;
  const std::string page = testing::evbench(folder, "man").out;
  CHECK(page.starts_with(".TH EVBENCH 1 "));
  for (const char* part : {".SS evbench run [OPTIONS] config\n", ".SS evbench dataset get ", "\\fB\\-\\-t_max_diff\\fR",
                           "\\fB\\-j\\fR, \\fB\\-\\-jobs\\fR", ".SH EXIT STATUS\n"}) {
    CHECK_THAT(page, ContainsSubstring(part));
  }
  if (shell(folder, "command -v groff").exit_code != 0) return;
  const Outcome shown = shell(folder, "\"$evbench\" man | groff -man -Tascii -rLL=100n");
  CHECK(shown.exit_code == 0);
  CHECK(shown.err.empty());
  CHECK_THAT(shown.out, ContainsSubstring("Score trajectories: ATE and RPE"));
}
