#pragma once

#include "core/events/formats.hpp"

// Every format of this folder: a function each, listed in ../formats.cpp.
namespace evbench {}  // namespace evbench
