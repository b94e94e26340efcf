#pragma once

#include <functional>
#include <string>

#include "bench/datasets/download.hpp"
#include "core/datasets/catalogue.hpp"

namespace evbench {

/// Downloads a dataset's files and unpacks them into `folder`, which appears when all of it is there. Until then
/// `folder`.download has the files, those that are complete and those that broke off, and the next call goes on from
/// there; an archive that is damaged is removed. `told` gets a line for each file, `download` has the pause, attempts
/// and progress of downloads. Throws InputError.
void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download,
                   const std::function<void(const std::string&)>& told);

}  // namespace evbench
