#include "core/datasets/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

const char* variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : nullptr;
}

bool is_name(const std::string& name) {
  static const std::regex pattern("[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*");
  return std::regex_match(name, pattern);
}

std::string with_name(std::string url, const std::string& name) {
  constexpr std::string_view kPlace = "{name}";
  for (std::size_t at = url.find(kPlace); at != std::string::npos; at = url.find(kPlace, at + name.size())) {
    url.replace(at, kPlace.size(), name);
  }
  return url;
}

Dataset::File read_file(const Json& json, const std::string& name) {
  Dataset::File file;
  file.url = with_name(json.at("url").get<std::string>(), name);
  file.sha256 = json.value("sha256", "");
  file.unpack = json.value("unpack", false);
  if (!file.url.starts_with("https://") && !file.url.starts_with("http://")) {
    throw InputError(fmt::format("url: is \"{}\"; expected http:// or https://", file.url));
  }
  const std::string path = file.url.substr(0, file.url.find_first_of("?#"));
  file.name = path.substr(path.find_last_of('/') + 1);
  if (file.name.empty() || file.name.starts_with('.') || path.find('/', path.find("://") + 3) == std::string::npos) {
    throw InputError(fmt::format("url: is \"{}\"; expected one that ends in a file's name", file.url));
  }
  if (!file.sha256.empty() && !std::regex_match(file.sha256, std::regex("[0-9a-f]{64}"))) {
    throw InputError(fmt::format("sha256: is \"{}\"; expected 64 hexadecimal digits", file.sha256));
  }
  return file;
}

/// Reads a sequence of a collection.
Dataset read_dataset(const Json& collection, const Json& sequence) {
  const auto name = sequence.at("name").get<std::string>();
  Dataset dataset;
  dataset.name = fmt::format("{}/{}", collection.at("name").get<std::string>(), name);
  if (!is_name(dataset.name)) throw InputError(fmt::format("name: is \"{}\"; expected words", dataset.name));
  dataset.description = sequence.at("description").get<std::string>();
  dataset.collection = collection.at("title").get<std::string>();
  dataset.licence = collection.at("licence").get<std::string>();
  dataset.homepage = collection.at("homepage").get<std::string>();
  dataset.verified = collection.at("verified").get<std::string>();
  dataset.limit_gib = collection.at("limit_gib").get<double>();
  for (const Json& file : sequence.contains("files") ? sequence.at("files") : collection.at("files")) {
    dataset.files.push_back(read_file(file, name));
    const std::string& last = dataset.files.back().name;
    if (std::ranges::count(dataset.files, last, &Dataset::File::name) > 1) {
      throw InputError(fmt::format("url: two of the files are called \"{}\"; expected another name for each", last));
    }
  }
  return dataset;
}

}  // namespace

std::string catalogue_path() {
  if (const char* const named = variable("EVBENCH_CATALOGUE")) return named;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share/evbench/configs/datasets.json";
  return !error && fs::exists(installed, error) ? installed.string() : EVBENCH_SOURCE_CATALOGUE;
}

std::vector<Dataset> read_catalogue(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: can't be read; expected the catalogue of datasets", path));
  std::vector<Dataset> datasets;
  std::string place = path;
  try {
    const Json json = parse_json(std::string(std::istreambuf_iterator<char>(file), {}));
    std::set<std::string> names;
    for (const Json& collection : json.at("collections")) {
      for (const Json& sequence : collection.at("sequences")) {
        place = fmt::format("{}: {}/{}", path, collection.value("name", "?"), sequence.value("name", "?"));
        datasets.push_back(read_dataset(collection, sequence));
        if (!names.insert(datasets.back().name).second) throw InputError("is there twice");
      }
    }
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
  }
  return datasets;
}

const Dataset& find_dataset(const std::vector<Dataset>& catalogue, const std::string& name) {
  const auto found = std::ranges::find(catalogue, name, &Dataset::name);
  if (found != catalogue.end()) return *found;
  std::vector<std::string> names;
  for (const Dataset& dataset : catalogue) names.push_back(dataset.name);
  throw InputError(fmt::format("no dataset is called \"{}\"{}", name, suggestion(name, names)));
}

std::string datasets_folder() {
  if (const char* const named = variable("EVBENCH_DATASETS")) return named;
  if (const char* const cache = variable("XDG_CACHE_HOME")) return std::string(cache) + "/evbench/datasets";
  if (const char* const home = variable("HOME")) return std::string(home) + "/.cache/evbench/datasets";
  throw InputError("neither EVBENCH_DATASETS nor HOME is set; expected one, to know where datasets are kept");
}

std::string dataset_folder(const std::string& name) {
  if (!is_name(name)) {
    throw InputError(fmt::format("\"{}\" is no name of a dataset; expected e.g. \"ecd/dynamic_6dof\"", name));
  }
  return datasets_folder() + "/" + name;
}

std::string existing_dataset_folder(const std::string& name, const std::string& place) {
  try {
    const std::string folder = dataset_folder(name);
    if (fs::is_directory(folder)) return folder;
    find_dataset(read_catalogue(catalogue_path()), name);
    throw InputError(fmt::format("the dataset {} is not in {}; fetch it with: evbench dataset get {}", name,
                                 datasets_folder(), name));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
  }
}

}  // namespace evbench
