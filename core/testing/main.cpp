#define CATCH_CONFIG_MAIN
#include "core/testing/catch2.hpp"
