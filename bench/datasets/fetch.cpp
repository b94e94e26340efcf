#include "bench/datasets/fetch.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "bench/datasets/unpack.hpp"
#include "core/io/archive.hpp"
#include "core/io/atomic_file.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

/// Moves a file or folder into a folder that has none of its name.
void move_into(const fs::path& folder, const fs::path& path) {
  const fs::path target = folder / path.filename();
  if (fs::exists(target)) {
    throw InputError(fmt::format("{}: is in two of the dataset's files", path.filename().string()));
  }
  fs::rename(path, target);
}

/// Unpacks an archive. A damaged one is removed, as it may be good when fetched again.
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

Json record_of_file(const char* key, const std::string& name, const std::string& path) {
  return {{key, name}, {"bytes", fs::file_size(path)}, {"sha256", sha256_file(path)}};
}

/// Size and SHA-256 of every file in a folder and below it, by its name there.
std::map<std::string, Json> records_of_files(const fs::path& folder) {
  std::map<std::string, Json> records;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    check_interruption();
    const std::string name = entry.path().lexically_relative(folder).generic_string();
    records[name] = record_of_file("name", name, entry.path().string());
  }
  return records;
}

}  // namespace

std::string record_of_dataset(const std::string& folder) { return folder + ".fetched.json"; }

std::vector<std::string> verify_dataset(const std::string& folder) {
  const std::string path = record_of_dataset(folder);
  if (!fs::is_directory(folder)) throw InputError(fmt::format("{}: no such folder; expected a dataset", folder));
  std::ifstream file(path);
  if (!file) {
    throw InputError(fmt::format("{}: no such file; expected what evbench dataset get wrote beside the dataset", path));
  }
  const Json record = try_parse_json(std::string(std::istreambuf_iterator<char>(file), {}));
  std::map<std::string, Json> expected;
  try {
    for (const Json& item : record.at("files")) expected[item.at("name").get<std::string>()] = item;
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: is no record of a dataset; expected an object with \"files\"", path));
  }
  std::map<std::string, Json> found = records_of_files(folder);
  std::vector<std::string> differences;
  for (const auto& [name, item] : expected) {
    const auto there = found.find(name);
    if (there == found.end()) {
      differences.push_back(fmt::format("{}/{}: is missing", folder, name));
    } else if (there->second != item) {
      differences.push_back(fmt::format("{}/{}: has {} bytes, SHA-256 {}; the record {} bytes, {}", folder, name,
                                        dump_json(there->second["bytes"]), dump_json(there->second["sha256"]),
                                        dump_json(item.value("bytes", Json())),
                                        dump_json(item.value("sha256", Json()))));
    }
    if (there != found.end()) found.erase(there);
  }
  for (const auto& [name, item] : found)
    differences.push_back(fmt::format("{}/{}: is not in the record", folder, name));
  return differences;
}

void fetch_dataset(const Dataset& dataset, const std::string& folder, const DownloadOptions& download_options,
                   const std::function<void(const std::string&)>& report) {
  AtomicFolder atomic(folder);  // locks, too
  const fs::path downloads = folder + ".download";
  fs::create_directories(downloads);
  DownloadOptions options = download_options;
  options.limit = static_cast<std::uint64_t>(dataset.limit_gib * 0x1p30);
  Json record = {{"downloads", Json::array()}, {"files", Json::array()}};
  for (const Dataset::File& file : dataset.files) {
    options.sha256 = file.sha256;
    const std::string path = downloads / file.name;
    // Files of an earlier call may be of another catalogue.
    if (fs::exists(path) && !file.sha256.empty() && sha256_file(path) != file.sha256) fs::remove(path);
    try {
      if (!fs::exists(path)) download(file.url, path, options);
    } catch (const InputError&) {
      std::error_code full;
      fs::remove(downloads, full);  // unless something is in it
      throw;
    }
    record["downloads"].push_back(record_of_file("url", file.url, path));
    report(fmt::format("{}: {} bytes, SHA-256 {} ({})", file.url, fs::file_size(path),
                       record["downloads"].back()["sha256"].get<std::string>(),
                       file.sha256.empty() ? "not compared: the catalogue has none" : "as the catalogue has it"));
  }
  // No download is used before all of them are checked.
  for (const Dataset::File& file : dataset.files) {
    if (file.unpack) unpack_into(atomic.part(), downloads / file.name, file.url, options.limit);
  }
  for (const Dataset::File& file : dataset.files) {
    if (!file.unpack) move_into(atomic.part(), downloads / file.name);
  }
  for (auto& [name, item] : records_of_files(atomic.part())) record["files"].push_back(std::move(item));
  write_file(record_of_dataset(folder), dump_json(record, 1) + "\n");
  atomic.commit();
  std::error_code ignored;
  fs::remove_all(downloads, ignored);
}

}  // namespace evbench
