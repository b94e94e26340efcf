#pragma once

#include <functional>
#include <string>

#include "bench/datasets/download.hpp"
#include "core/data/datasets.hpp"

namespace evbench {

/// Downloads a dataset's files and unpacks them into `folder`, which appears when all of it is there; downloads that
/// break off stay in `folder`.download and go on with the next call. `told` gets a line for each step, `download` has
/// the pause, attempts and progress of downloads. Throws InputError.
void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download,
                   const std::function<void(const std::string&)>& told);

}  // namespace evbench
