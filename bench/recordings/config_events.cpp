#include "bench/recordings/config_events.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "bench/experiment.hpp"
#include "core/events/formats.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

class ConfigEvents : public EventReader {
 public:
  ConfigEvents(const std::string& path, const ReadOptions& options, const Plugins& plugins)
      : path_(path), strict_(options.strict), source_(read_source(path, plugins)), reader_(source_->all_events()) {
    if (!reader_) throw InputError(fmt::format("{}: its source has no events", path));
    if (!options.topic.empty() || !options.ground_truth_topic.empty() || !options.camera_info_topic.empty() ||
        !options.columns.empty()) {
      throw InputError(fmt::format("{}: is a config, which has neither topics nor columns", path));
    }
  }

  const StreamInfo& info() const override { return reader_->info(); }
  bool read(std::vector<Event>& events) override {
    const bool any = reader_->read(events);
    const auto& faults = reader_->faults().all();
    if (strict_ && !faults.empty()) {
      throw InputError(fmt::format("{}: {}: {}", path_, faults.begin()->second.first, faults.begin()->first));
    }
    return any;
  }
  void seek(std::int64_t t) override { reader_->seek(t); }
  const Faults& faults() const override { return reader_->faults(); }
  std::optional<Camera> calibration() override { return source_->camera(); }
  std::optional<PoseTrajectory> ground_truth() override {
    if (source_->ground_truth().empty()) return std::nullopt;
    return source_->ground_truth();
  }

 private:
  std::string path_;
  bool strict_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<EventReader> reader_;
};

bool begins_like_json(const std::string& path) {
  return std::filesystem::is_regular_file(path) && (std::ifstream(path) >> std::ws).peek() == '{';
}

}  // namespace

std::function<std::unique_ptr<EventReader>(const std::string&, const ReadOptions&)> recordings_and_configs(
    const Plugins& plugins) {
  return [&plugins](const std::string& path, const ReadOptions& options) -> std::unique_ptr<EventReader> {
    if (begins_like_json(path)) return std::make_unique<ConfigEvents>(path, options, plugins);
    return open_events(path, options);
  };
}

}  // namespace evbench
