// Precompiled header of tests.
#include "cmake/precompiled.hpp"
#include "core/testing/catch2.hpp"
