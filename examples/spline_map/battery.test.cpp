#include <evbench/plugin.hpp>
#include <evbench/plugin_test.hpp>

using namespace evbench;

TEST_CASE("The back-end passes evbench's conformance battery") {
  const Plugins plugins = registered_plugins();
  for (const battery::Check& check : battery::backend_checks(plugins, "spline_map")) {
    INFO(check.name);
    CHECK_NOTHROW(check.run());
  }
}
