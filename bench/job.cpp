#include "bench/job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "core/io/path.hpp"
#include "core/io/sha256.hpp"
#include "core/plugin/write_options.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// Incremented when the pipeline itself gives other results for the same job (exchanges, delivery of feedback,
/// re-initialisation, sampling and writing of trajectories). Older runs are then not reused.
constexpr int kPipelineVersion = 4;

std::string digest_of_folder(const std::string& path) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  }
  std::ranges::sort(files);  // the order of a folder's entries is undefined
  std::string list;
  for (const std::string& file : files) {
    list += fmt::format("{}  {}\n", sha256_file(file), fs::path(file).lexically_relative(path).generic_string());
  }
  return sha256(list);
}

/// The files that a source reads in this job: events only if the front-end reads them.
std::vector<std::string> source_files(const Job& job, const SourceFiles& source, const Plugins& plugins) {
  std::vector<std::string> files = source.files;
  if (plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place + ".type").reads_events) {
    std::ranges::copy(source.events, std::back_inserter(files));
  }
  return files;
}

/// Collects the parts of an identity, and the files that are read.
class Identifier {
 public:
  Identifier(const Job& job, const Plugins& plugins, Digests& digests)
      : job_(job), plugins_(plugins), digests_(digests) {}

  /// `files`: those that the plugin reads.
  template <class Interface>
  Json part(const PluginConfig& config, const std::vector<std::string>& files) {
    const auto& entry = plugins_.of<Interface>().find(config.type, config.place + ".type");
    Json part = {{"type", config.type}, {"version", entry.version}, {"options", entry.identity(config.options)}};
    part["files"] = Json::array();
    for (const std::string& file : files) part["files"].push_back(digest(file));
    if (entry.origin != kBuiltIn) part["library"] = digest(entry.origin);
    return part;
  }

  /// The files in a plugin's options.
  template <class Interface>
  std::vector<std::string> named_files(const PluginConfig& config) const {
    const auto& entry = plugins_.of<Interface>().find(config.type, config.place + ".type");
    std::vector<std::string> files;
    for (const std::string& file : entry.files(config.options)) files.push_back(resolve_path(file, job_.folder));
    return files;
  }

  std::vector<std::pair<std::string, std::string>> take_files() { return std::move(files_); }

 private:
  std::string digest(const std::string& path) {
    const std::string& digest = digests_.of(path);
    if (std::ranges::find(files_, path, &std::pair<std::string, std::string>::first) == files_.end()) {
      files_.emplace_back(path, digest);
    }
    return digest;
  }

  const Job& job_;
  const Plugins& plugins_;
  Digests& digests_;
  std::vector<std::pair<std::string, std::string>> files_;
};

}  // namespace

Json PluginConfig::with_type() const {
  Json json = {{"type", type}};
  json.update(options);
  return json;
}

const std::string& Digests::of(const std::string& path) {
  const auto found = known_.find(path);
  if (found != known_.end()) return found->second;
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(fmt::format("{}: no such file", path));
  const std::string digest = fs::is_directory(path, error) ? digest_of_folder(path) : sha256_file(path);
  return known_.emplace(path, digest).first->second;
}

std::string digits_of_key(const std::string& text) { return sha256(text).substr(0, 10); }

JobIdentity identify(const Job& job, const SourceFiles& source, const Plugins& plugins, Digests& digests) {
  Identifier identifier(job, plugins, digests);
  Json json = {{"pipeline_version", kPipelineVersion},
               {"seed", job.seed},
               {"trajectory_rate", job.trajectory_rate},
               {"pipeline", write_options(job.pipeline)}};
  json["source"] = identifier.part<Source>(job.source, source_files(job, source, plugins));
  json["frontend"] = identifier.part<FrontEnd>(job.frontend, identifier.named_files<FrontEnd>(job.frontend));
  json["backend"] = identifier.part<BackEnd>(job.backend, identifier.named_files<BackEnd>(job.backend));
  JobIdentity identity;
  identity.text = dump_json(json, 2) + "\n";
  identity.key = fmt::format("{}-{}", job.backend.type, digits_of_key(identity.text));
  identity.files = identifier.take_files();
  return identity;
}

std::unique_ptr<Source> make_source(const Job& job, const Plugins& plugins) {
  const auto& entry = plugins.of<Source>().find(job.source.type, job.source.place + ".type");
  return entry.make(job.source.options, {job.seed, job.folder, job.source.place});
}

}  // namespace evbench
