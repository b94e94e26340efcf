#pragma once

/// \file
/// For the entry points of a plugin, which evbench_add_plugin() compiles into it.

#include "core/plugin/abi.hpp"
#include "core/plugin/registration.hpp"
