#include "core/events/hdf5/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/data/calibration_fields.hpp"
#include "core/events/hdf5/columns.hpp"
#include "core/events/hdf5/file.hpp"
#include "core/events/hdf5/layout.hpp"
#include "core/events/hdf5/meaning.hpp"
#include "core/events/hdf5/table.hpp"
#include "core/events/hdf5/trial.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

using hdf5::kBroken, hdf5::kNoPolarity;

class Hdf5Reader : public EventReader {
 public:
  Hdf5Reader(const std::string& path, const ReadOptions& options);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return faults_; }
  std::optional<Camera> calibration() override;

 private:
  void describe(const ReadOptions& options);
  void find_sensor(const ReadOptions& options);
  void load();
  void drop_broken(std::uint64_t row, std::vector<Event>& events);
  std::int64_t time(std::uint64_t row) const { return table_.time(row, meaning_.scale); }

  hdf5::File file_;
  hdf5::EventLayout layout_;
  EventColumns asked_;
  hdf5::EventTable table_;
  hdf5::Meaning meaning_;
  hdf5::Dataset index_;
  hdf5::EventTable::Piece loaded_;
  StreamInfo info_;
  Faults faults_, opening_faults_;
  std::uint64_t length_;    ///< events
  std::uint64_t next_ = 0;  ///< row
};

Hdf5Reader::Hdf5Reader(const std::string& path, const ReadOptions& options)
    : file_(path),
      layout_(choose_events(file_, options.topic)),
      asked_(options.columns.empty() ? EventColumns()
                                     : named_event_columns(options.columns, path + ": what is asked for")),
      table_(file_, layout_, asked_.order),
      meaning_(find_meaning(file_, layout_, table_, asked_.unit)),
      faults_(path, options.strict),
      opening_faults_(faults_),
      length_(table_.rows()) {
  if (!layout_.index.empty()) index_ = file_.dataset(layout_.index);
  if (table_.surplus() > 0) {
    faults_.add("columns of different length", fmt::format("row {}", length_),
                static_cast<std::int64_t>(table_.surplus()));
  }
  describe(options);
  opening_faults_ = faults_;
}

void Hdf5Reader::describe(const ReadOptions& options) {
  info_.format = fmt::format("HDF5 ({})", layout_.name);
  info_.count = static_cast<std::int64_t>(length_);
  if (length_ > 0) {
    const std::int64_t start = time(0), end = time(length_ - 1);
    if (start != kBroken) info_.start = start;
    if (end != kBroken) info_.end = end;
  }
  for (const auto& object : file_.objects()) {
    if (!object.is_dataset) continue;
    try {
      const hdf5::Dataset dataset = file_.dataset(object.path);
      info_.topics.push_back(fmt::format("/{} ({}), {} rows", object.path, dataset.describe(), dataset.rows()));
    } catch (const InputError&) {
      info_.topics.push_back(fmt::format("/{} (not numbers, or not readable)", object.path));
    }
  }
  info_.metadata.emplace_back("events in", "/" + layout_.group);
  if (layout_.is_rows()) info_.metadata.emplace_back("columns", to_string(table_.order()));
  info_.metadata.emplace_back("unit of time", to_string(meaning_.scale.unit) + meaning_.unit_origin);
  if (meaning_.unit_is_guessed) info_.guessed_time_unit = meaning_.scale.unit;
  if (meaning_.scale.offset != 0) {
    info_.metadata.emplace_back("t_offset [us]", fmt::to_string(meaning_.scale.offset));
  }
  find_sensor(options);
}

/// The size from the calibration or an attribute of the file; otherwise from the options, or as known of the data set.
void Hdf5Reader::find_sensor(const ReadOptions& options) {
  const std::string group = layout_.is_rows() ? "" : layout_.group;
  std::optional<Camera> camera;
  try {
    camera = calibration();
  } catch (const InputError&) {
    // Reported when the calibration is read.
  }
  if (camera) {
    info_.width = camera->width;
    info_.height = camera->height;
  } else if (const auto size = hdf5::find_sensor_size(file_, group)) {
    std::tie(info_.width, info_.height) = *size;
  } else {
    info_.size_assumed = true;
    info_.width = options.width > 0 ? options.width : layout_.width;
    info_.height = options.height > 0 ? options.height : layout_.height;
    if (options.width <= 0 && layout_.width > 0) {
      info_.metadata.emplace_back("sensor size", fmt::format("{}'s; the file does not say it", layout_.name));
    }
  }
}

bool Hdf5Reader::read(std::vector<Event>& events) {
  constexpr std::uint64_t kEventsAtOnce = 1 << 14;  // they stay in the second-level cache
  while (next_ < length_) {
    if (next_ < loaded_.begin || next_ >= loaded_.end) load();
    events.resize(std::min(kEventsAtOnce, loaded_.end - next_));
    const std::uint64_t row = next_;
    next_ += events.size();
    if (!to_events(table_.views(loaded_, row), meaning_.scale, meaning_.darker, events)) drop_broken(row, events);
    if (!events.empty()) return true;
  }
  events.clear();
  return false;
}

/// Loads rows from the next one on: so many that the cost of a call of the library does not matter.
void Hdf5Reader::load() {
  const std::uint64_t most = layout_.is_rows() ? 1 << 14 : 1 << 17;
  table_.read(next_, std::min(length_, (next_ / most + 1) * most), loaded_);
  if (meaning_.darker != hdf5::Darker::unsaid) return;
  hdf5::DarkerCount count;
  count.add(table_.views(loaded_, loaded_.begin).p, loaded_.end - loaded_.begin);
  meaning_.darker = count.darker();
}

void Hdf5Reader::drop_broken(std::uint64_t row, std::vector<Event>& events) {
  const auto report = [&](const std::string& kind, const auto& is_wrong) {
    const auto first = std::ranges::find_if(events, is_wrong);
    if (first == events.end()) return;
    const std::string where = fmt::format("row {}", row + static_cast<std::uint64_t>(first - events.begin()));
    faults_.add(kind, where, std::ranges::count_if(events, is_wrong));
  };
  report("events whose x, y or t is no pixel or no time", [](const Event& event) { return event.t == kBroken; });
  report(
      fmt::format("events whose polarity is neither {} nor 1", meaning_.darker == hdf5::Darker::minus_one ? "-1" : "0"),
      [](const Event& event) { return event.t == kNoPolarity; });
  std::erase_if(events, [](const Event& event) { return event.t <= kNoPolarity; });
}

/// By the index of milliseconds where it agrees with the times, otherwise by bisection of the times.
void Hdf5Reader::seek(std::int64_t t) {
  faults_ = opening_faults_;
  const auto may_start_at = [&](std::uint64_t row) { return row == 0 || (row <= length_ && time(row - 1) < t); };
  next_ = 0;
  if (length_ == 0 || t <= time(0)) return;
  const std::uint64_t ms = (static_cast<std::uint64_t>(t) - static_cast<std::uint64_t>(meaning_.scale.offset)) / 1000;
  if (!layout_.index.empty() && t > meaning_.scale.offset && ms < index_.rows()) {
    const double row = index_.first(ms);
    if (row >= 0.0 && row <= static_cast<double>(length_) && may_start_at(static_cast<std::uint64_t>(row))) {
      next_ = static_cast<std::uint64_t>(row);
      return;
    }
  }
  std::uint64_t before = 0, after = length_;  // time(before) < t ≤ time(after)
  while (after - before > 1) {
    const std::uint64_t middle = before + (after - before) / 2;
    (time(middle) < t ? before : after) = middle;
  }
  next_ = after;
}

/// M3ED: the group calib next to the columns.
std::optional<Camera> Hdf5Reader::calibration() {
  const std::string group = layout_.group + "/calib/";
  const auto place = [&](const char* name) { return fmt::format("{}: /{}{}", file_.path(), group, name); };
  const auto numbers = [&](const char* name, std::size_t count) {
    const std::vector<double> values = file_.dataset(group + name).read_all(100);
    if (values.size() != count) {
      throw InputError(fmt::format("{}: has {} numbers; expected {}", place(name), values.size(), count));
    }
    return values;
  };
  for (const char* name : {"intrinsics", "distortion_coeffs", "resolution"}) {
    if (!file_.has_dataset(group + name)) return std::nullopt;
  }
  if (file_.has_dataset(group + "camera_model") && file_.text(group + "camera_model") != "pinhole") {
    throw InputError(
        fmt::format("{}: is \"{}\"; expected pinhole", place("camera_model"), file_.text(group + "camera_model")));
  }
  DistortionModel distortion = DistortionModel::radial_tangential;
  if (file_.has_dataset(group + "distortion_model")) {
    distortion = named_distortion(place("distortion_model"), file_.text(group + "distortion_model"));
  }
  const std::vector<double> size = numbers("resolution", 2);
  return checked_camera(place(""), numbers("intrinsics", 4), distortion, numbers("distortion_coeffs", 4),
                        checked_side(place("resolution"), size[0]), checked_side(place("resolution"), size[1]));
}

/// The signature is at the beginning, or after a user block of 512, 1024, ... bytes.
bool has_signature(std::span<const std::byte> head) {
  constexpr unsigned char kSignature[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
  for (std::size_t at = 0; at + 8 <= head.size(); at = at == 0 ? 512 : 2 * at) {
    if (std::equal(std::begin(kSignature), std::end(kSignature), head.begin() + static_cast<std::ptrdiff_t>(at),
                   [](unsigned char a, std::byte b) { return std::byte{a} == b; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::unique_ptr<EventReader> open_hdf5(const std::string& path, const ReadOptions& options) {
  return std::make_unique<Hdf5Reader>(path, options);
}

EventFormat hdf5_format() {
  return {"hdf5", "HDF5 as in DSEC, MVSEC, TUM-VIE, M3ED, EDS, v2e",
          [](const std::string&, std::span<const std::byte> head) { return has_signature(head); },
          [](const std::string& path, const ReadOptions& options) {
            hdf5::try_events(path, options.topic, options.columns);
            return open_hdf5(path, options);
          },
          true};
}

}  // namespace evbench
