// The entry points that make a shared library an evbench plugin: evbench_add_plugin compiles them into each plugin.
#include <evbench/plugin_entry.hpp>

extern "C" __attribute__((visibility("default"))) const char* evbench_plugin_abi() { return evbench::plugin_abi(); }

extern "C" __attribute__((visibility("default"))) void evbench_plugin_add(evbench::Plugins& plugins,
                                                                          const char* origin) {
  evbench::add_registered_plugins(plugins, origin);
}
