#include "bench/datasets/fetch.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "bench/datasets/unpack.hpp"
#include "core/support/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/sha256.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

std::string name_in(const std::string& url) {
  const std::string path = url.substr(0, url.find_first_of("?#"));
  return path.substr(path.find_last_of('/') + 1);
}

/// Everything in a folder into another one that has none of it.
void move_content(const fs::path& from, const fs::path& to) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path target = to / entry.path().filename();
    if (fs::exists(target)) throw InputError(fmt::format("{}: is in two of the dataset's files", target.string()));
    fs::rename(entry.path(), target);
  }
  fs::remove(from);
}

}  // namespace

void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download_options,
                   const std::function<void(const std::string&)>& told) {
  AtomicFolder atomic(folder);  // locks, too
  const fs::path downloads = folder + ".download";
  fs::create_directories(downloads);
  for (const Dataset::File& file : dataset.files) {
    DownloadOptions options = download_options;
    options.sha256 = file.sha256;
    options.limit = static_cast<std::uint64_t>(dataset.limit_gib * 0x1p30);
    const fs::path path = downloads / name_in(file.url);
    if (!fs::exists(path)) download(file.url, path.string(), options);
    told(fmt::format("{}: {} bytes, SHA-256 {} ({})", file.url, fs::file_size(path), sha256_file(path.string()),
                     file.sha256.empty() ? "not compared: the catalogue has none" : "as the catalogue has it"));
    if (file.unpack) {
      const fs::path unpacked = downloads / "unpacked";
      fs::remove_all(unpacked);
      fs::create_directory(unpacked);
      unpack(path.string(), unpacked.string(), options.limit);
      move_content(unpacked, atomic.part());
    } else {
      fs::rename(path, fs::path(atomic.part()) / path.filename());
    }
  }
  atomic.commit();
  std::error_code ignored;
  fs::remove_all(downloads, ignored);
}

}  // namespace evbench
