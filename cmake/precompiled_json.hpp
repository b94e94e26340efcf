// Precompiled header of sources that read and write JSON.
#include <nlohmann/json.hpp>

#include "cmake/precompiled.hpp"
