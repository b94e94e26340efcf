// Faulty libraries for library.test.cpp; a macro selects the fault.
#include <cstdlib>
#include <stdexcept>

#include "core/plugin/abi.hpp"

namespace evbench {
class Plugins;
}

#ifdef MISSING_SYMBOL
void nobody_has_this();
#endif

#ifdef OTHER_ABI
const char* evbench_test_text = EVBENCH_PLUGIN_ABI_MARK "api 99; gcc 3; no sanitizer";
extern const int must_not_run;
const int must_not_run = (std::abort(), 0);
extern "C" const char* evbench_plugin_abi() { return evbench_test_text; }
#elif !defined(NO_PLUGIN)
extern "C" const char* evbench_plugin_abi() { return evbench::plugin_abi(); }
#endif

#ifndef NO_PLUGIN
extern "C" void evbench_plugin_add(evbench::Plugins&, const char*) {
#ifdef MISSING_SYMBOL
  nobody_has_this();
#endif
#ifdef THROWS
  throw std::runtime_error("the licence server is down");
#endif
}
#endif
