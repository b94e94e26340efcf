#include "core/data/pose_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/data/columns.hpp"
#include "core/data/pose_record.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr std::array kQuantities{
    kTime,
    Quantity{"px", "((.*_)?(p|t|pos|position|trans|translation)(_.*)?_?)?x"},
    Quantity{"py", "((.*_)?(p|t|pos|position|trans|translation)(_.*)?_?)?y"},
    Quantity{"pz", "((.*_)?(p|t|pos|position|trans|translation)(_.*)?_?)?z"},
    Quantity{"qx", "(.*_)?(q|quat|quaternion|orientation|rot|rotation)(_.*)?_?x"},
    Quantity{"qy", "(.*_)?(q|quat|quaternion|orientation|rot|rotation)(_.*)?_?y"},
    Quantity{"qz", "(.*_)?(q|quat|quaternion|orientation|rot|rotation)(_.*)?_?z"},
    Quantity{"qw", "(.*_)?(q|quat|quaternion|orientation|rot|rotation)(_.*)?_?w"},
    Quantity{"r11", "r_?11"},
    Quantity{"r12", "r_?12"},
    Quantity{"r13", "r_?13"},
    Quantity{"r21", "r_?21"},
    Quantity{"r22", "r_?22"},
    Quantity{"r23", "r_?23"},
    Quantity{"r31", "r_?31"},
    Quantity{"r32", "r_?32"},
    Quantity{"r33", "r_?33"},
};
constexpr std::span kPosition(&kQuantities[1], 3), kQuaternion(&kQuantities[4], 4), kMatrix(&kQuantities[8], 9);

struct Layout {
  PoseFormat format;
  const char* columns;
};

constexpr Layout kLayouts[] = {
    {PoseFormat::tum, "t px py pz qx qy qz qw"},
    {PoseFormat::kitti, "r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz"},
    {PoseFormat::kitti, "r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz - - - -"},
    {PoseFormat::robotevt, "t r11 r12 r13 r21 r22 r23 r31 r32 r33 px py pz"},
    {PoseFormat::kitti, "t r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz"},
    {PoseFormat::kitti, "t r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz - - - -"},
    {PoseFormat::euroc, "t px py pz qw qx qy qz - - - - - - - - -"},
    {PoseFormat::euroc, "t px py pz qw qx qy qz"},
};

std::array<Quantity, 4> quaternion_in(QuaternionOrder order) {
  std::array<Quantity, 4> quaternion;
  std::ranges::rotate_copy(kQuaternion, kQuaternion.end() - (index(order) - index(QuaternionOrder::xyzw)),
                           quaternion.begin());
  return quaternion;
}

/// Reads the pose of a record from its columns.
class PoseColumns {
 public:
  explicit PoseColumns(const Columns& columns)
      : position_(columns.find_all(kPosition)),
        quaternion_(columns.find_all(kQuaternion)),
        matrix_(columns.find_all(kMatrix)) {}

  bool complete() const { return !position_.empty() && !(quaternion_.empty() && matrix_.empty()); }

  SE3 read(const TextReader& reader) const {
    return {quaternion_.empty() ? read_rotation_matrix(reader, matrix_) : read_quaternion(reader, quaternion_),
            read_vector3(reader, position_, "the position")};
  }

  bool fits(const TextReader& reader) const {
    try {
      read(reader);
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

 private:
  std::vector<std::size_t> position_, quaternion_, matrix_;
};

/// Has the record commas and nanoseconds since 1970? VINS and other tools for EuRoC write such files, without names and
/// with quaternions in EuRoC's order.
bool looks_like_euroc(const TextReader& reader) {
  return reader.text().find(',') != std::string::npos &&
         usual_time_unit(reader.number(0, "the time")) == TimeUnit::nanoseconds;
}

/// The layout from the number of columns: of the given format, or the first of all formats whose rotation is valid.
/// Layouts with a quaternion may have further columns.
Columns find_layout(const TextReader& reader, PoseFormat format) {
  const std::size_t count = reader.columns().size();
  std::vector<Layout> layouts;
  std::ranges::copy_if(kLayouts, std::back_inserter(layouts), [&](const Layout& layout) {
    return format == PoseFormat::automatic || layout.format == format;
  });
  if (format == PoseFormat::automatic && looks_like_euroc(reader)) {
    std::stable_partition(layouts.begin(), layouts.end(),
                          [](const Layout& layout) { return layout.format == PoseFormat::euroc; });
  }
  std::vector<Columns> known, fitting;
  for (const Layout& layout : layouts) known.emplace_back(layout.columns, kQuantities);
  for (const Columns& columns : known) {
    if (columns.size() == count) fitting.push_back(columns);
  }
  for (const Columns& columns : known) {
    if (columns.size() < count && columns.find("qw")) fitting.push_back(columns.followed_to(count));
  }
  if (fitting.empty()) reader.expect_columns(known.front().size(), known.front().text().c_str());
  const auto rotating = std::ranges::find_if(fitting, [&](const Columns& c) { return PoseColumns(c).fits(reader); });
  return rotating == fitting.end() ? fitting.front() : *rotating;
}

/// The columns with the quaternion in the order of the options.
Columns in_order(const Columns& columns, QuaternionOrder order, const TextReader& reader) {
  if (order == QuaternionOrder::automatic) return columns;
  if (columns.find_all(kQuaternion).empty()) {
    reader.fail(fmt::format("has no quaternion (columns {}), whose order is given as {}", columns.text(),
                            kQuaternionOrderNames[index(order)]));
  }
  return columns.in_order(quaternion_in(order));
}

/// Quaternion order of consecutive columns.
QuaternionOrder order_of(const Columns& columns) {
  const std::vector<std::size_t> at = columns.find_all(kQuaternion);
  for (const auto order :
       {QuaternionOrder::xyzw, QuaternionOrder::wxyz, QuaternionOrder::zwxy, QuaternionOrder::yzwx}) {
    if (!at.empty() && columns.in_order(quaternion_in(order)).find_all(kQuaternion) == at) return order;
  }
  return QuaternionOrder::automatic;
}

/// Times of the poses in sequence: from a column, from a separate file, or numbers.
class PoseTimes {
 public:
  PoseTimes(const TextReader& poses, const Columns& columns, const PoseFileOptions& options) {
    if (columns.find(kTime.name)) {
      column_.emplace(poses, columns, options.time_unit);
    } else if (!options.times.empty()) {
      file_.emplace(options.times);
      if (file_->next()) column_.emplace(*file_, Columns(kTime.name, kQuantities), options.time_unit);
    } else if (!options.may_number) {
      poses.fail(fmt::format("has no time (columns {}); expected times in it, or the name of a file with a time a line",
                             columns.text()));
    }
  }

  /// [s]; unchanged from the file if unknown_unit() is not empty at the end.
  double next(const TextReader& poses) {
    if (!file_) return column_ ? read(poses) : static_cast<double>(number_++);
    if (file_->columns().empty()) poses.fail(fmt::format("has no time in {}; expected a time a pose", file_->path()));
    const double t = read(*file_);
    file_->next();
    return t;
  }

  /// Called after the last pose.
  void expect_end() const {
    if (file_ && !file_->columns().empty()) file_->fail("a time without a pose; expected a time a pose");
  }

  bool numbered() const { return !column_; }
  TimeUnit unit() const { return column_ ? column_->unit() : TimeUnit::seconds; }
  const std::string& unknown_unit() const { return unknown_unit_; }

 private:
  /// A unit guessed from the first time may turn out to be wrong: 5e10 followed by 2e11.
  double read(const TextReader& reader) {
    const double t = column_->read(reader);
    const double count = t * per_second(column_->unit());
    const auto usual = usual_time_unit(count);
    if (column_->is_guessed() && unknown_unit_.empty() && !(usual && *usual == column_->unit())) {
      unknown_unit_ = fmt::format("{}: {}", reader.place(), unknown_time_unit(count));
    }
    return t;
  }

  std::optional<TimeColumn> column_;
  std::optional<TextReader> file_;
  std::int64_t number_ = 0;
  std::string unknown_unit_;
};

/// Is the file unambiguously a TUM file?
bool is_usual(const TextReader& first, const Columns& columns, bool named) {
  const bool by_blanks = first.text().find_first_of(",;") == std::string::npos;
  return columns.text() == kLayouts[0].columns && (named || by_blanks);
}

/// Remark on what was assumed about the layout; empty for the usual layout.
std::string assumption(const TextReader& first, bool named, const Columns& columns, const PoseTimes& times,
                       const PoseFileOptions& options) {
  const bool asked = options.format != PoseFormat::automatic && columns.text().find('-') == std::string::npos;
  std::string text;
  if (!asked && !is_usual(first, columns, named)) {
    text += fmt::format(", columns {} ({}{})", columns.text(), named ? "as they are named" : "assumed",
                        options.quaternion == QuaternionOrder::automatic ? "" : "; the quaternion as requested");
  }
  if (times.numbered()) text += ", without times: poses are numbered";
  if (options.time_unit == TimeUnit::unsaid && per_second(times.unit()) != 1.0) {
    text += ", times in " + to_string(times.unit());
  }
  return text.empty() ? "" : fmt::format("{}: read with{}", first.path(), text.substr(1));
}

}  // namespace

PoseFile read_poses(const std::string& path, const PoseFileOptions& options) {
  TextReader reader(path);
  const auto expect_poses = [&] {
    if (reader.columns().empty()) throw InputError(fmt::format("{}: holds no pose; expected at least one", path));
  };
  reader.next();
  expect_poses();
  std::optional<Columns> named;
  if (options.format == PoseFormat::automatic) {
    const auto complete = [](const Columns& c) { return PoseColumns(c).complete(); };
    named = read_names(reader, kQuantities, complete, kLayouts[0].columns);
  } else {
    pass_over_names(reader);
  }
  expect_poses();
  const Columns columns = in_order(named ? *named : find_layout(reader, options.format), options.quaternion, reader);
  const PoseColumns pose(columns);
  PoseTimes times(reader, columns, options);

  PoseFile file;
  file.numbered = times.numbered();
  file.quaternion = order_of(columns);
  file.quaternion_is_assumed = !named && options.format == PoseFormat::automatic &&
                               options.quaternion == QuaternionOrder::automatic && !is_usual(reader, columns, false);
  if (const auto text = assumption(reader, named.has_value(), columns, times, options); !text.empty()) {
    file.remarks.push_back(text);
  }
  constexpr std::size_t kVelocity = 8;  // column
  if (options.velocities && columns.size() != kVelocity + 3) {
    reader.fail(fmt::format("has {} columns; expected t, position, quaternion and vx vy vz", columns.size()));
  }
  std::vector<StampedPose> poses;
  std::vector<StampedVelocity> velocities;
  std::string first_repeated;
  std::int64_t repeated = 0;
  for (; !reader.columns().empty(); reader.next()) {
    reader.expect_columns(columns.size(), columns.text().c_str());
    const double t = times.next(reader);
    const SE3 T = pose.read(reader);
    if (!poses.empty() && t < poses.back().t) {
      reader.fail(fmt::format("time {:.9f} s is before the one before it ({:.9f} s); expected increasing times", t,
                              poses.back().t));
    }
    if (poses.empty() || t > poses.back().t) {
      poses.push_back({t, T});
      if (options.velocities) {
        velocities.push_back({t, Vector6::Zero()});
        velocities.back().velocity.tail<3>() = read_vector3(reader, consecutive<3>(kVelocity), "the velocity");
      }
    } else if (repeated++ == 0) {
      first_repeated = reader.place();
    }
  }
  times.expect_end();
  if (!options.may_lack_unit && !times.unknown_unit().empty()) throw InputError(times.unknown_unit());
  file.unknown_unit = times.unknown_unit();
  if (repeated > 0) {
    file.remarks.push_back(fmt::format("{}: {} pose{} with the time of the one before, left out; the first: {}", path,
                                       repeated, repeated == 1 ? "" : "s", first_repeated));
  }
  file.trajectory = PoseTrajectory(std::move(poses), path);
  file.velocities = BodyVelocities(std::move(velocities));
  return file;
}

void set_time_unit(PoseFile& file, TimeUnit unit) {
  const auto in_seconds = [&](auto stamped) {
    for (auto& one : stamped) one.t /= per_second(unit);
    const auto same_time = [](const auto& a, const auto& b) { return a.t == b.t; };
    stamped.erase(std::unique(stamped.begin(), stamped.end(), same_time), stamped.end());
    return stamped;
  };
  file.trajectory = PoseTrajectory(in_seconds(std::move(file.trajectory).poses()));
  file.velocities = BodyVelocities(in_seconds(file.velocities.all()));
  file.unknown_unit.clear();
}

}  // namespace evbench
