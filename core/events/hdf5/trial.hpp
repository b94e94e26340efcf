#pragma once

#include <string>
#include <vector>

namespace evbench::hdf5 {

/// Both throw InputError when the HDF5 library crashes on a file, or does not come to an end with it, as that of Debian
/// 12 (1.10.8) does with some broken ones. A process of its own tries it first, the program evbench-hdf5-trial
/// (trial_main.cpp), which is looked for beside the one that runs; without it there is no trial.

/// Of all that the reader of events gives but for most of the events: numbers that are broken elsewhere are beyond
/// that. `topic`, `columns`: ReadOptions'.
void try_events(const std::string& path, const std::string& topic, const std::string& columns);

/// Of whole data sets; a missing one is for the caller to find.
void try_datasets(const std::string& path, const std::vector<std::string>& names);

}  // namespace evbench::hdf5
