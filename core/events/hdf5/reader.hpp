#pragma once

#include <memory>
#include <string>

#include "core/events/formats.hpp"

namespace evbench {

/// Opens an HDF5 file of events in one of the layouts of layout.hpp, without the trial of trial.hpp. Throws InputError
/// for files that are broken or have no events.
std::unique_ptr<EventReader> open_hdf5(const std::string& path, const ReadOptions& options);

/// The format. It opens a file after a trial.
EventFormat hdf5_format();

}  // namespace evbench
