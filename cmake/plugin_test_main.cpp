// The main function of test programs, of plugins and of evbench.
#define CATCH_CONFIG_RUNNER
#include <evbench/plugin_test.hpp>

int main(int argc, char** argv) { return Catch::Session().run(argc, argv); }
