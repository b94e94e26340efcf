#include "core/events/companions/companions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/events/companions/data_sets.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr auto kDataSets = {ecd_companions,  dsec_companions, tumvie_companions,
                            m3ed_companions, eds_companions,  mvsec_companions};

/// A reader with the calibration, ground truth and sensor size of its companion files.
class AccompaniedReader : public EventReader {
 public:
  AccompaniedReader(std::unique_ptr<EventReader> reader, Companions companions,
                    std::shared_ptr<const RecordingFiles> files, const ReadOptions& options);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override { return reader_->read(events); }
  void seek(std::int64_t t) override { reader_->seek(t); }
  const Faults& faults() const override { return reader_->faults(); }
  std::optional<PoseTrajectory> ground_truth() override;
  std::optional<Camera> calibration() override;
  std::vector<std::string> companion_files() const override {
    return {companion_files_.begin(), companion_files_.end()};
  }

 private:
  void find_sensor(const ReadOptions& options);
  void take_metadata();
  std::unique_ptr<EventReader> reader_;
  Companions companions_;  ///< what the reader itself doesn't have
  std::shared_ptr<const RecordingFiles> files_;
  StreamInfo info_;
  std::size_t taken_;  ///< entries of the reader's metadata already copied
  std::set<std::string> companion_files_;
};

AccompaniedReader::AccompaniedReader(std::unique_ptr<EventReader> reader, Companions companions,
                                     std::shared_ptr<const RecordingFiles> files, const ReadOptions& options)
    : reader_(std::move(reader)),
      companions_(std::move(companions)),
      files_(std::move(files)),
      info_(reader_->info()),
      taken_(info_.metadata.size()) {
  const auto has_own = [](const auto& get) {
    try {
      return get().has_value();
    } catch (const InputError&) {
      return true;  // broken: reported when it is read
    }
  };
  if (companions_.calibration && has_own([&] { return reader_->calibration(); })) companions_.calibration.reset();
  if (companions_.ground_truth && has_own([&] { return reader_->ground_truth(); })) companions_.ground_truth.reset();
  take_metadata();
  const bool stated = options.width > 0 && options.height > 0;
  if (!stated && (info_.size_assumed || info_.width <= 0 || info_.height <= 0)) find_sensor(options);
  const auto note = [&](const char* what, const auto& found) {
    if (found) info_.metadata.emplace_back(what, fmt::format("{} ({})", fmt::join(found->names, ", "), found->whose));
  };
  note("calibration", companions_.calibration);
  note("ground truth", companions_.ground_truth);
  if (companions_.ground_truth && !companions_.ground_truth->remark.empty()) {
    info_.metadata.emplace_back("remark", companions_.ground_truth->remark);
  }
}

/// Copies the reader's new metadata: it describes calibration and ground truth only once they have been read.
void AccompaniedReader::take_metadata() {
  const auto& metadata = reader_->info().metadata;
  info_.metadata.insert(info_.metadata.end(), metadata.begin() + static_cast<std::ptrdiff_t>(taken_), metadata.end());
  taken_ = metadata.size();
}

std::optional<Camera> AccompaniedReader::calibration() {
  if (!companions_.calibration) {
    const auto own = reader_->calibration();
    take_metadata();
    return own;
  }
  for (const std::string& name : companions_.calibration->names) companion_files_.insert(files_->path(name));
  return companions_.calibration->read(info_.width, info_.height);
}

std::optional<PoseTrajectory> AccompaniedReader::ground_truth() {
  if (!companions_.ground_truth) {
    auto own = reader_->ground_truth();
    take_metadata();
    return own;
  }
  for (const std::string& name : companions_.ground_truth->names) companion_files_.insert(files_->path(name));
  PoseFile file = companions_.ground_truth->read();
  for (std::string& text : file.remarks) {
    std::pair<std::string, std::string> remark("remark", std::move(text));
    if (std::ranges::count(info_.metadata, remark) == 0) info_.metadata.push_back(std::move(remark));
  }
  return std::move(file.trajectory);
}

/// A size in the calibration takes precedence over an assumed one, but not over an option.
void AccompaniedReader::find_sensor(const ReadOptions& options) {
  int width = 0, height = 0;
  std::string whose = "the calibration's";
  bool assumed = false;
  try {
    if (companions_.calibration) {
      const Camera camera = companions_.calibration->read(0, 0);
      width = camera.width;
      height = camera.height;
    }
  } catch (const InputError&) {
    // Reported when the calibration is read.
  }
  if (width <= 0 && info_.width <= 0 && companions_.sensor) {
    width = companions_.sensor->width;
    height = companions_.sensor->height;
    whose = companions_.sensor->whose;
    assumed = true;
  }
  if (width <= 0) return;
  info_.size_assumed = assumed;
  info_.width = options.width > 0 ? options.width : width;
  info_.height = options.height > 0 ? options.height : height;
  std::erase_if(info_.metadata, [](const auto& entry) { return entry.first == "sensor size"; });
  info_.metadata.emplace_back("sensor size", whose);
}

/// "left" or "right", whichever is the last whole word; "" without one.
std::string side_in(const std::string& name) {
  constexpr const char* kDelimiters = "_-./ ";
  std::string side;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of(kDelimiters, begin), name.size());
    const std::string word = name.substr(begin, end - begin);
    if (word == "left" || word == "right") side = word;
    begin = end + 1;
  }
  return side;
}

/// From the topic; if it says nothing, from the file's name, and then from its folder's.
bool is_right(const std::filesystem::path& events, const std::string& topic) {
  for (const std::string& name : {topic, events.filename().string(), events.parent_path().filename().string()}) {
    if (const std::string side = side_in(name); !side.empty()) return side == "right";
  }
  return false;
}

}  // namespace

std::string EventsPlace::name_before(const std::string& end) const {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.ends_with(end) ? name.substr(0, name.size() - end.size()) : "";
}

std::string only(const RecordingFiles& files, const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  throw InputError(fmt::format("{}: is next to {}; expected the sequence's own alone", files.path(names.back()),
                               fmt::join(names.begin(), names.end() - 1, ", ")));
}

std::string partner(const EventsPlace& place, const std::string& end, const std::string& partners_end) {
  const std::string name = place.name_before(end);
  if (!name.empty()) return place.files->has(name + partners_end) ? name + partners_end : "";
  const auto all = place.files->matching("*" + partners_end);
  return all.size() == 1 ? all.front() : "";
}

Companions find_companions(const std::shared_ptr<const RecordingFiles>& files, const std::string& topic) {
  const std::string path = files->events();
  const EventsPlace place{files, path, is_right(path, topic)};
  Companions companions;
  for (const auto& data_set : kDataSets) {
    Companions found = data_set(place);
    if (!companions.calibration) companions.calibration = std::move(found.calibration);
    if (!companions.ground_truth) companions.ground_truth = std::move(found.ground_truth);
    if (!companions.sensor) companions.sensor = std::move(found.sensor);
  }
  return companions;
}

std::unique_ptr<EventReader> with_companions(std::unique_ptr<EventReader> reader,
                                             const std::shared_ptr<const RecordingFiles>& files,
                                             const ReadOptions& options) {
  Companions companions = find_companions(files, options.topic);
  if (!companions.calibration && !companions.ground_truth && !companions.sensor) return reader;
  return std::make_unique<AccompaniedReader>(std::move(reader), std::move(companions), files, options);
}

}  // namespace evbench
