#include "bench/recordings/config_events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "bench/experiment.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

class ConfigEvents : public EventReader {
 public:
  ConfigEvents(const std::string& path, const ReadOptions& options, const Plugins& plugins)
      : path_(path), strict_(options.strict), source_(read_source(path, plugins)), reader_(source_->all_events()) {
    if (!reader_) throw InputError(fmt::format("{}: its source has no events", path));
    if (!options.topic.empty() || !options.columns.empty()) {
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

bool begins_like_json(const std::string&, std::span<const std::byte> head) {
  const auto first =
      std::ranges::find_if(head, [](std::byte b) { return std::isspace(static_cast<unsigned char>(b)) == 0; });
  return first != head.end() && *first == std::byte{'{'};
}

}  // namespace

EventFormat config_format(const Plugins& plugins) {
  return {"config", "JSON config of evbench: the events of its source", begins_like_json,
          [&plugins](const std::string& path, const ReadOptions& options) {
            return std::make_unique<ConfigEvents>(path, options, plugins);
          },
          /*has_companions=*/false};
}

}  // namespace evbench
