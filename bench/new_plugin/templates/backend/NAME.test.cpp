#include <evbench/plugin.hpp>
#include <evbench/plugin_test.hpp>

using namespace evbench;

TEST_CASE("NAME passes the conformance battery") {
  const Plugins plugins = registered_plugins();
  for (const battery::Check& check : battery::backend_checks(plugins, "NAME")) {
    INFO(check.name);
    CHECK_NOTHROW(check.run());
  }
}

TEST_CASE("NAME reports a wrong option") {
  const Plugins plugins = registered_plugins();
  const auto& entry = plugins.of<BackEnd>().find("NAME", "test");
  CHECK_THROWS_WITH(entry.resolve({{"period", 0}}, "test", ""),
                    Catch::Matchers::ContainsSubstring("period: 0 is out of range"));
}
