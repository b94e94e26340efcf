// The same for the program's commands.
#include <CLI/CLI.hpp>

#include "cmake/precompiled.hpp"
