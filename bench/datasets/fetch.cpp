#include "bench/datasets/fetch.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "bench/datasets/unpack.hpp"
#include "core/io/archive.hpp"
#include "core/io/atomic_file.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

/// A file or folder into a folder that has none of its name.
void move_into(const fs::path& folder, const fs::path& path) {
  const fs::path target = folder / path.filename();
  if (fs::exists(target)) {
    throw InputError(fmt::format("{}: is in two of the dataset's files", path.filename().string()));
  }
  fs::rename(path, target);
}

/// An archive that is of no use is removed: fetched once more, it may be good.
void unpack_into(const fs::path& folder, const fs::path& archive, const std::string& url, std::uint64_t limit) {
  const fs::path unpacked = folder / ".unpacked";
  fs::create_directory(unpacked);
  try {
    unpack(archive.string(), unpacked.string(), limit);
  } catch (const BadArchive& error) {
    fs::remove(archive);
    throw InputError(fmt::format("{}: removed, the same command fetches {} again", error.what(), url));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(unpacked)) move_into(folder, entry.path());
  fs::remove(unpacked);
}

}  // namespace

void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download_options,
                   const std::function<void(const std::string&)>& told) {
  AtomicFolder atomic(folder);  // locks, too
  const fs::path downloads = folder + ".download";
  fs::create_directories(downloads);
  DownloadOptions options = download_options;
  options.limit = static_cast<std::uint64_t>(dataset.limit_gib * 0x1p30);
  for (const Dataset::File& file : dataset.files) {
    options.sha256 = file.sha256;
    const std::string path = downloads / file.name;
    // What an earlier call left may be of another catalogue.
    if (fs::exists(path) && !file.sha256.empty() && sha256_file(path) != file.sha256) fs::remove(path);
    try {
      if (!fs::exists(path)) download(file.url, path, options);
    } catch (const InputError&) {
      std::error_code full;
      fs::remove(downloads, full);  // unless something is in it
      throw;
    }
    told(fmt::format("{}: {} bytes, SHA-256 {} ({})", file.url, fs::file_size(path), sha256_file(path),
                     file.sha256.empty() ? "not compared: the catalogue has none" : "as the catalogue has it"));
  }
  // Nothing is taken from the downloads before all of it is known to be good.
  for (const Dataset::File& file : dataset.files) {
    if (file.unpack) unpack_into(atomic.part(), downloads / file.name, file.url, options.limit);
  }
  for (const Dataset::File& file : dataset.files) {
    if (!file.unpack) move_into(atomic.part(), downloads / file.name);
  }
  atomic.commit();
  std::error_code ignored;
  fs::remove_all(downloads, ignored);
}

}  // namespace evbench
