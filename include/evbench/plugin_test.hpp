#pragma once

/// \file
/// For tests of plugins: Catch2 and the conformance battery.

#include "bench/battery/battery.hpp"
#include "core/plugin/registration.hpp"
#include "core/testing/catch2.hpp"
