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

/// Which part of a recording, and with which zero.
struct StreamOptions {
  ReadOptions read = {};
  bool rebase = false;  ///< times from the first event on; otherwise the file's own
  /// [µs] after rebasing; the end is not included.
  std::optional<std::int64_t> from = {}, to = {};
  /// Sensor of the camera that the events are for [px]; 0: the recording's own.
  int width = 0, height = 0;
  /// A sentence, where that size is only assumed: an event outside it is then an InputError, unless the options are
  /// lenient.
  std::string size_assumption = {};
  /// Opens what a path names; empty: open_events() (formats.hpp), for recordings.
  std::function<std::unique_ptr<EventReader>(const std::string& path, const ReadOptions& options)> open = {};
};

/// A recording's events in time order, within the sensor (its own, and the camera's where one is given), in a time
/// range: what everybody but the readers uses. Events out of order, outside the sensor or beyond ±2^61 µs are left out
/// and counted as faults (errors in strict mode); of those out of order as few as possible, in view of two chunks of
/// the reader. Reading can be interrupted (interruption.hpp).
class EventStream {
 public:
  /// Throws InputError for what is no recording and by check_sensor_size(). Of the target evbench_events.
  EventStream(const std::string& path, const StreamOptions& options = {});
  EventStream(std::unique_ptr<EventReader> reader, std::string path, const StreamOptions& options = {});

  /// Replaces `events` by the next ones. False, and none, at the end, where a large loss is an InputError unless the
  /// options are lenient.
  bool read(std::vector<Event>& events);

  /// A sentence when more than a tenth of what was read since the beginning or the last seek had to be left out: a
  /// broken recording, or one that is misread.
  std::optional<std::string> large_loss() const;

  /// Reading goes on with the first event at or after t [µs, after rebasing].
  void seek(std::int64_t t);

  /// The file's time of this stream's zero [µs].
  std::int64_t zero() const { return zero_; }
  const StreamInfo& info() const { return reader_->info(); }
  EventReader& reader() { return *reader_; }

  /// The largest coordinates of all events read so far [px]; −1 before the first.
  int max_x() const { return max_x_; }
  int max_y() const { return max_y_; }

  /// The reader's and this stream's, since the beginning or the last seek.
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
  std::vector<Event> ahead_;  ///< the reader's next ones
  std::int64_t zero_ = 0;
  std::int64_t from_ = kBeginning, end_ = kEnd;  ///< the file's time
  std::int64_t newest_ = kBeginning;             ///< likewise
  std::int64_t good_ = 0;                        ///< events, of the time range or not
  bool ended_ = false;
  int max_x_ = -1, max_y_ = -1;
};

}  // namespace evbench
