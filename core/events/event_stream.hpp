#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench {

/// Which part of a recording to read, and where its time is zero.
struct StreamOptions {
  ReadOptions read = {};
  bool rebase = false;  ///< time is zero at the first event; otherwise the file's own time
  /// [µs] after rebasing; the end is not included.
  std::optional<std::int64_t> from = {}, to = {};
  /// Sensor of the camera that uses the events [px]; 0: the recording's own.
  int width = 0, height = 0;
  /// A sentence to report if that size is only assumed: an event outside it is then an InputError, unless the options
  /// are lenient.
  std::string size_assumption = {};
  /// Opens a path; empty: open_events() (formats.hpp), for recordings.
  std::function<std::unique_ptr<EventReader>(const std::string& path, const ReadOptions& options)> open = {};
};

/// A recording's events in time order, within the sensor (its own, and the camera's if one is given) and in a time
/// range. Everything but the readers themselves reads events through it. Events out of order, outside the sensor or
/// beyond ±2^61 µs are left out and counted as faults (errors in strict mode). Of the events out of order as few as
/// possible are left out, considering two chunks of the reader. Reading can be interrupted (interruption.hpp).
class EventStream {
 public:
  /// Throws InputError for a path that is no recording, and as check_sensor_size() does. Part of the target
  /// evbench_events.
  EventStream(const std::string& path, const StreamOptions& options = {});
  EventStream(std::unique_ptr<EventReader> reader, std::string path, const StreamOptions& options = {});

  /// Replaces `events` by the next ones. At the end there are none and it returns false; a large loss is then an
  /// InputError, unless the options are lenient.
  bool read(std::vector<Event>& events);

  /// A sentence if more than a tenth of the events since the beginning or the last seek had to be left out: the
  /// recording is broken or misread.
  std::optional<std::string> large_loss() const;

  /// Continues with the first event at or after t [µs, after rebasing].
  void seek(std::int64_t t);

  /// The file's time at this stream's zero [µs].
  std::int64_t zero() const { return zero_; }
  const StreamInfo& info() const { return reader_->info(); }
  EventReader& reader() { return *reader_; }

  /// The largest coordinates of all events read so far [px]; −1 before the first.
  int max_x() const { return max_x_; }
  int max_y() const { return max_y_; }

  /// The reader's and this stream's faults since the beginning or the last seek.
  std::vector<std::pair<std::string, Faults::Fault>> faults() const;

 private:
  static constexpr std::int64_t kBeginning = std::numeric_limits<std::int64_t>::min();
  static constexpr std::int64_t kEnd = std::numeric_limits<std::int64_t>::max();

  void find_zero();
  void seek_reader(std::int64_t t);
  bool next_chunk(std::vector<Event>& events);
  bool overlaps_next(std::span<const Event> events) const;
  void check(std::vector<Event>& events);
  void note_extent(std::span<const Event> events);
  void leave_out_outside(std::vector<Event>& events, int width, int height);
  void leave_out_disorder(std::vector<Event>& events);

  std::string path_;
  bool lenient_;
  int width_, height_;  ///< of the camera
  std::string size_assumption_;
  std::unique_ptr<EventReader> reader_;
  Faults faults_;
  std::vector<Event> ahead_;  ///< the reader's next events
  std::int64_t zero_ = 0;
  std::int64_t from_ = kBeginning, end_ = kEnd;  ///< [µs] in the file's time
  std::int64_t newest_ = kBeginning;             ///< [µs] likewise, of the last event
  std::int64_t good_ = 0;                        ///< events kept, in the time range or not
  bool ended_ = false;
  int max_x_ = -1, max_y_ = -1;
};

}  // namespace evbench
