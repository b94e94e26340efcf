#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/failures.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/datasets/download.hpp"
#include "bench/datasets/fetch.hpp"
#include "core/datasets/catalogue.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr const char* kPlace =
    "Datasets are kept in the folder EVBENCH_DATASETS, by default ~/.cache/evbench/datasets, each in a subfolder of\n"
    "its name. NAME.download next to it has the files of an incomplete download; NAME.fetched.json has address, size\n"
    "and SHA-256 of the download and of every file. A source of type recording uses a dataset by its name:\n"
    "{\"dataset\": \"ecd/dynamic_6dof\"}. Each dataset has its own licence.";

/// "1234.5 MiB", the size of all its files as reported by the servers; "?" if one does not report it.
std::string size_text(const Dataset& dataset) {
  double mib = 0.0;
  for (const Dataset::File& file : dataset.files) {
    const std::optional<std::uint64_t> size = remote_size(file.url);
    if (!size) return "?";
    mib += static_cast<double>(*size) * 0x1p-20;
  }
  return fmt::format("{:.1f} MiB", mib);
}

void list_datasets(bool sizes) {
  const Interruption interruption("interrupted");
  std::string collection;
  for (const Dataset& dataset : read_catalogue(catalogue_path())) {
    if (dataset.collection != collection) {
      collection = dataset.collection;
      fmt::print("{}\n  {}, {}\n", collection, dataset.homepage, dataset.licence);
    }
    const bool there = std::filesystem::is_directory(dataset_folder(dataset.name));
    const std::string size = sizes ? fmt::format("{:>12}  ", size_text(dataset)) : "";
    fmt::print("  {} {:<28} {}{}\n", there ? '*' : ' ', dataset.name, size, dataset.description);
    check_interruption();
  }
  fmt::print("\n*: in {}\n", datasets_folder());
}

void get_dataset(const std::string& name, bool quiet) {
  const std::vector<Dataset> catalogue = read_catalogue(catalogue_path());
  const Dataset& dataset = find_dataset(catalogue, name);
  const std::string folder = dataset_folder(name);
  ProgressLine progress(name, quiet);
  const auto print_line = [&](const std::string& line) {
    if (quiet) return;
    progress.clear();
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  if (std::filesystem::is_directory(folder)) {
    print_line(fmt::format("{}: is there already", folder));
    return;
  }
  print_line(
      fmt::format("{}: {}\nLicence: {}; see {}", dataset.name, dataset.collection, dataset.licence, dataset.homepage));
  const Interruption interruption(name + ": interrupted; the same command continues from there");
  DownloadOptions options;
  options.progress = [&](std::uint64_t have, std::optional<std::uint64_t> total) {
    const double mib = static_cast<double>(have) * 0x1p-20;
    progress.update(total ? fmt::format("{:.1f} of {:.1f} MiB", mib, static_cast<double>(*total) * 0x1p-20)
                          : fmt::format("{:.1f} MiB", mib));
  };
  fetch_dataset(dataset, folder, options, print_line);
  print_line("written: " + folder);
}

void verify(const std::string& name) {
  const Interruption interruption(name + ": interrupted");
  const std::string folder = existing_dataset_folder(name, name);
  const std::vector<std::string> differences = verify_dataset(folder);
  if (!differences.empty()) throw_together(differences);
  fmt::print("{}: as it was fetched\n", folder);
}

}  // namespace

void add_dataset(CLI::App& app) {
  struct Arguments {
    std::string name;
    bool quiet = false, sizes = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("dataset", "List and fetch public recordings");
  command->require_subcommand(1);
  CLI::App* list = command->add_subcommand("list", "List the catalogue; a star marks local datasets");
  list->add_flag("--sizes", arguments->sizes, "Ask the servers how large the downloads are");
  list->callback([arguments] { list_datasets(arguments->sizes); });
  CLI::App* get = command->add_subcommand("get", "Fetch a dataset; an interrupted download is continued");
  get->footer(kPlace);
  get->add_option("name", arguments->name, "Name, e.g. ecd/dynamic_6dof")->required();
  get->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  get->callback([arguments] { get_dataset(arguments->name, arguments->quiet); });
  CLI::App* verify_command =
      command->add_subcommand("verify", "Compare a dataset's files with what was fetched, byte for byte");
  verify_command->footer(kPlace);
  verify_command->add_option("name", arguments->name, "Name, e.g. ecd/dynamic_6dof")->required();
  verify_command->callback([arguments] { verify(arguments->name); });
  command->footer(kPlace);
}

}  // namespace evbench
