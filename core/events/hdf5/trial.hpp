#pragma once

#include <string>
#include <vector>

namespace evbench::hdf5 {

/// Both throw InputError if the HDF5 library crashes or hangs on a file, as version 1.10.8 in Debian 12 does with some
/// broken ones. A separate process tries the file first: the program evbench-hdf5-trial (trial_main.cpp), which is
/// searched for in the folder of the running program. Without it there is no trial.

/// Tries all that the reader of events does, but reads only a few of the events: numbers that are broken elsewhere stay
/// unnoticed. `topic`, `columns`: as in ReadOptions.
void try_events(const std::string& path, const std::string& topic, const std::string& columns);

/// Tries whole data sets; missing ones are left to the caller to find.
void try_datasets(const std::string& path, const std::vector<std::string>& names);

}  // namespace evbench::hdf5
