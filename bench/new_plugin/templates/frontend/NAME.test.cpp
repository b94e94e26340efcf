#include <evbench/plugin.hpp>
#include <evbench/plugin_test.hpp>

using namespace evbench;

TEST_CASE("NAME passes the conformance battery") {
  const Plugins plugins = registered_plugins();
  for (const battery::Check& check :
       battery::frontend_checks(plugins, "NAME", Json::object(), battery::usual_source())) {
    INFO(check.name);
    CHECK_NOTHROW(check.run());
  }
}
