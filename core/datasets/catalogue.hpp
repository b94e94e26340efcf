#pragma once

#include <string>
#include <vector>

namespace evbench {

/// A public recording that `evbench dataset get` can fetch.
struct Dataset {
  struct File {
    std::string url;
    std::string name;     ///< end of the address, e.g. "dynamic_6dof.zip"; unique within a dataset
    std::string sha256;   ///< 64 digits; empty: unknown
    bool unpack = false;  ///< an archive (zip, tar.gz)
  };
  std::string name;         ///< collection/sequence, e.g. "ecd/dynamic_6dof"
  std::string description;  ///< one line
  std::string collection;   ///< the collection's title
  std::string licence, homepage;
  std::string verified;    ///< how the addresses were verified
  double limit_gib = 0.0;  ///< maximum size of a file and of an archive's content
  std::vector<File> files;
};

/// The path of the catalogue (configs/datasets.json): the file that EVBENCH_CATALOGUE names, else the one installed
/// with the program, else the one of the source tree.
std::string catalogue_path();

/// Reads the catalogue. Throws InputError with the place in the file for a catalogue that is missing or
/// not as described in docs/guides/recordings.md.
std::vector<Dataset> read_catalogue(const std::string& path);

/// Finds a dataset by name. Throws InputError with the nearest name for an unknown one.
const Dataset& find_dataset(const std::vector<Dataset>& catalogue, const std::string& name);

/// The folder that datasets are kept in: EVBENCH_DATASETS, or ~/.cache/evbench/datasets.
std::string datasets_folder();

/// The folder of a dataset below it, whether or not it exists. Throws InputError for a name that is not words and
/// slashes.
std::string dataset_folder(const std::string& name);

/// The folder of a downloaded dataset. Throws an InputError that begins with `place`: for a dataset that is not there
/// with the command that fetches it, for an unknown name with the nearest one.
std::string existing_dataset_folder(const std::string& name, const std::string& place);

}  // namespace evbench
