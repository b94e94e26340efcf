#include "bench/commands/number_check.hpp"

#include "bench/commands/commands.hpp"
#include "core/testing/catch2.hpp"

namespace evbench {
namespace {

bool takes(CLI::Option& option, const std::string& value) {
  option.clear();
  for (int i = 0; i < std::max(option.get_items_expected_min(), 1); ++i) option.add_result(value);
  try {
    option.run_callback();
    return true;
  } catch (const CLI::ParseError&) {
    return false;
  }
}

}  // namespace

TEST_CASE("No option of any command takes a number that is not finite") {
  CLI::App app;
  Plugins plugins;
  int exit_code = 0;
  add_commands(app, plugins, exit_code);
  int numbers = 0;
  for (CLI::App* command : app.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() == 0 || takes(*option, "text")) continue;
      CAPTURE(command->get_name(), option->get_name());
      for (const char* value : {"nan", "-nan", "inf", "-inf", "Infinity", "1e999"}) CHECK_FALSE(takes(*option, value));
      numbers += takes(*option, "25.5") ? 1 : 0;
    }
  }
  CHECK(numbers >= 25);
}

TEST_CASE("A number's check says what is expected") {
  CHECK(finite_number()("nan") == "nan: expected a finite number");
  CHECK(above_zero()("0") == "0: expected a finite number above 0");
  CHECK(not_negative()("-1") == "-1: expected a finite number of at least 0");
  CHECK(in_range(0.5, 2.0)("nan") == "nan: expected a finite number from 0.5 to 2");
  for (const char* good : {"1", "+1", "1e-1", "2"}) {
    CHECK(finite_number()(good).empty());
    CHECK(above_zero()(good).empty());
  }
}

}  // namespace evbench
