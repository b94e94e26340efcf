#include "bench/sweep/shared_events.hpp"

#include <filesystem>
#include <utility>
#include <vector>

#include "core/events/native/keeping_reader.hpp"
#include "core/events/native/native.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

/// The properties of a source, apart from its events.
class RecordedEvents : public Source {
 public:
  /// `keep`: whether a missing recording is made while the events are read.
  RecordedEvents(std::unique_ptr<Source> source, std::string path, bool keep)
      : source_(std::move(source)), path_(std::move(path)), keep_(keep) {}

  const Camera& camera() const override { return source_->camera(); }
  TimeRange time_range() const override { return source_->time_range(); }
  const PoseTrajectory& ground_truth() const override { return source_->ground_truth(); }
  /// Another sweep that no longer needs the events may have removed the recording: they are then made again.
  std::unique_ptr<EventReader> all_events() const override {
    if (keep_) return kept_events();
    std::error_code error;
    if (!std::filesystem::exists(path_, error)) return source_->all_events();
    return std::make_unique<NativeReader>(path_);
  }
  std::string size_assumption() const override { return source_->size_assumption(); }
  bool is_lenient() const override { return source_->is_lenient(); }
  bool silence_is_known() const override { return source_->silence_is_known(); }
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return source_->true_tracks(); }
  std::shared_ptr<const PointTruth> point_truth() const override { return source_->point_truth(); }
  std::vector<std::string> files() const override { return source_->files(); }
  std::vector<std::string> event_files() const override { return source_->event_files(); }
  std::vector<std::string> remarks() const override { return source_->remarks(); }

 private:
  std::unique_ptr<EventReader> kept_events() const {
    try {
      return read_or_keep(path_, [this] { return source_->all_events(); });
    } catch (const InputError&) {  // no room for a file: the events are made again by each run
      return source_->all_events();
    }
  }

  std::unique_ptr<Source> source_;
  std::string path_;
  bool keep_;
};

/// Whether a recording is complete; a damaged one would leave out events.
bool is_intact(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  try {
    NativeReader reader(path);
    for (std::vector<Event> events; reader.read(events);) {
    }
    return reader.faults().all().empty();
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

bool record_events(const Source& source, const std::string& path) {
  const std::unique_ptr<EventReader> reader = source.event_files().empty() ? source.all_events() : nullptr;
  if (!reader) return false;
  RecordingHeader header;
  header.width = reader->info().width;
  header.height = reader->info().height;
  NativeWriter writer(path, header);
  for (std::vector<Event> events; reader->read(events);) writer.write(events);
  writer.finish();
  return true;
}

std::unique_ptr<Source> with_recorded_events(std::unique_ptr<Source> source, const std::string& path) {
  if (!is_intact(path)) return source;
  return std::make_unique<RecordedEvents>(std::move(source), path, false);
}

std::unique_ptr<Source> with_kept_events(std::unique_ptr<Source> source, const std::string& path) {
  return std::make_unique<RecordedEvents>(std::move(source), path, true);
}

}  // namespace evbench
