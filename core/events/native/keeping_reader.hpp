#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/events/native/native.hpp"
#include "core/io/part_file.hpp"

namespace evbench {

/// A reader that writes what it reads to a file of the native format. The file appears when all events were read, from
/// the first to the last; reading goes on without it where the disk is full.
class KeepingReader : public EventReader {
 public:
  /// Throws InputError if no file can be made there.
  KeepingReader(std::unique_ptr<EventReader> reader, const std::string& path);

  const StreamInfo& info() const override { return reader_->info(); }
  bool read(std::vector<Event>& events) override;
  /// Only events that follow one another are kept: after a seek beyond the beginning there is no file.
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return reader_->faults(); }
  std::optional<PoseTrajectory> ground_truth() override { return reader_->ground_truth(); }
  std::optional<Camera> calibration() override { return reader_->calibration(); }
  std::vector<std::string> companion_files() const override { return reader_->companion_files(); }

 private:
  void begin();
  void give_up();

  std::unique_ptr<EventReader> reader_;
  std::string path_;
  std::unique_ptr<PartFile> file_;  ///< none: nothing is kept
  std::unique_ptr<NativeWriter> writer_;
  bool begun_ = false;
};

/// The events of the file, where it is there, or else those of `make` in a KeepingReader; nullptr if there are none.
std::unique_ptr<EventReader> read_or_keep(const std::string& path,
                                          const std::function<std::unique_ptr<EventReader>()>& make);

}  // namespace evbench
