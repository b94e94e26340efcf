#pragma once

#include "core/events/formats.hpp"

namespace evbench {

/// HDF5 files of events in one of the layouts of layout.hpp, by rows or by columns.
EventFormat hdf5_format();

}  // namespace evbench
