// The same for tests.
#include <catch2/catch.hpp>

#include "cmake/precompiled.hpp"
