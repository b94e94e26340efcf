#pragma once

#include <string>
#include <vector>

namespace evbench {

/// A public recording that `evbench dataset get` can fetch.
struct Dataset {
  struct File {
    std::string url;
    std::string name;     ///< that the address ends in, e.g. "dynamic_6dof.zip"; each file of a dataset has another
    std::string sha256;   ///< 64 digits; empty: unknown
    bool unpack = false;  ///< an archive (zip, tar.gz)
  };
  std::string name;         ///< collection/sequence, e.g. "ecd/dynamic_6dof"
  std::string description;  ///< one line
  std::string collection;   ///< the collection's title
  std::string licence, homepage;
  std::string verified;    ///< how it is known that the addresses are right
  double limit_gib = 0.0;  ///< what a file, and an archive's content, may have at most
  std::vector<File> files;
};

/// The catalogue (configs/datasets.json): the file that EVBENCH_CATALOGUE names, or the one installed with the program,
/// or that of the sources that it was built from.
std::string catalogue_path();

/// By name. Throws InputError, naming the place in the file, for a catalogue that is missing or not as described in
/// configs/datasets.md.
std::vector<Dataset> read_catalogue(const std::string& path);

/// Throws InputError with the nearest name for an unknown one.
const Dataset& find_dataset(const std::vector<Dataset>& catalogue, const std::string& name);

/// The folder that datasets are kept in: EVBENCH_DATASETS, or ~/.cache/evbench/datasets.
std::string datasets_folder();

/// A dataset's folder below it, there or not. Throws InputError for a name that is not words and slashes.
std::string dataset_folder(const std::string& name);

/// The folder of a dataset that is there; otherwise throws an InputError that says how to get it, or that begins with
/// `place` and has the nearest name for one that isn't known.
std::string existing_dataset_folder(const std::string& name, const std::string& place);

}  // namespace evbench
