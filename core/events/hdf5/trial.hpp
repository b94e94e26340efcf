#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/events/reader.hpp"

namespace evbench::hdf5 {

/// Throws InputError when the HDF5 library crashes on a file, or does not come to an end with it, as that of Debian 12
/// (1.10.8) does with some broken ones. A copy of this process (core/support/trial.hpp) opens it and reads all that a
/// reader gives but for most of the events: numbers that are broken elsewhere are beyond that.
void refuse_crashes(const std::string& path, const std::function<std::unique_ptr<EventReader>()>& open);

}  // namespace evbench::hdf5
