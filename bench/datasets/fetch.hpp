#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/datasets/download.hpp"
#include "core/datasets/catalogue.hpp"

namespace evbench {

/// Downloads a dataset's files and unpacks them into `folder`, which appears when it is complete. Until then
/// `folder`.download has the complete and partial files, and the next call goes on from there. A damaged archive is
/// removed. record_of_dataset(folder) has the size and SHA-256 of the downloads and of every file made from them, for
/// verify_dataset(). `report` is called with a line for each file; `download` has the pause, attempts and progress of
/// downloads. Throws InputError.
void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download,
                   const std::function<void(const std::string&)>& report);

/// `folder`.fetched.json: {"downloads": [{"url", "bytes", "sha256"}], "files": [{"name", "bytes", "sha256"}]}.
std::string record_of_dataset(const std::string& folder);

/// Compares a dataset's files with its record. Returns a sentence for each that is missing, has changed or is not in
/// the record. Throws InputError for a folder or a record that is missing or broken.
std::vector<std::string> verify_dataset(const std::string& folder);

}  // namespace evbench
