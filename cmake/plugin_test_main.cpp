// The main function of test programs, a plugin's own and evbench's.
#define CATCH_CONFIG_RUNNER
#include "core/testing/catch2.hpp"

int main(int argc, char** argv) { return Catch::Session().run(argc, argv); }
