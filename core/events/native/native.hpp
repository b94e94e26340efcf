#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/events/formats.hpp"
#include "core/events/native/layout.hpp"
#include "core/events/reader.hpp"
#include "core/events/writer.hpp"
#include "core/io/file_mapping.hpp"

namespace evbench {

/// Reads evbench's own cache format (layout.hpp): mapped into memory, 4 or 8 bytes an event. A chunk's checksum is
/// verified when it is read first. Pages that have been read are returned to the kernel: memory does not grow with the
/// file.
///
/// Throws InputError for a file that is truncated, of another version, or whose header or index is damaged. A damaged
/// chunk is a fault (reader.hpp): its events are left out.
class NativeReader : public EventReader {
 public:
  explicit NativeReader(const std::string& path, const ReadOptions& options = {});
  /// Reads bytes that the caller keeps; `name` is for messages.
  NativeReader(std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options = {});

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  void seek(std::int64_t t) override;  ///< by the index, O(log n)
  const Faults& faults() const override { return faults_; }
  std::optional<PoseTrajectory> ground_truth() override { return ground_truth_; }
  std::optional<Camera> calibration() override { return calibration_; }

 private:
  NativeReader(std::unique_ptr<FileMapping> mapping, std::span<const std::byte> bytes, const std::string& name,
               const ReadOptions& options);
  void read_header();
  void read_index();
  void check_chunk(std::size_t number, std::uint64_t offset) const;
  void read_metadata();
  void hold(std::size_t offset, std::size_t size);
  bool is_intact(std::size_t number);
  [[noreturn]] void fail(const std::string& message) const;

  std::unique_ptr<FileMapping> mapping_;  ///< none for bytes in memory
  std::span<const std::byte> bytes_;
  std::string name_;
  native::Header header_;
  std::vector<native::Chunk> chunks_;
  std::vector<bool> verified_;                 ///< by chunk
  std::size_t next_ = 0;                       ///< chunk
  std::size_t held_begin_ = 0, held_end_ = 0;  ///< bytes of the mapping not yet returned to the kernel
  StreamInfo info_;
  std::optional<Camera> calibration_;
  std::optional<PoseTrajectory> ground_truth_;
  Faults faults_, opening_faults_;
};

/// Writes the native format. Times must not decrease.
class NativeWriter : public EventWriter {
 public:
  /// `name`: the file's, for messages; empty: the path.
  NativeWriter(const std::string& path, const RecordingHeader& header, const std::string& name = {});
  ~NativeWriter() override;
  NativeWriter(const NativeWriter&) = delete;
  NativeWriter& operator=(const NativeWriter&) = delete;

  void write(std::span<const Event> events) override;
  void finish() override;

 private:
  void check(const Event& event) const;
  void end_chunk();
  void put(std::span<const std::byte> bytes);

  std::string name_, metadata_;
  native::Header header_;
  std::vector<native::Chunk> chunks_;
  std::vector<Event> pending_;
  std::int64_t newest_;  ///< [µs]
  std::uint64_t size_ = 0;
  void* file_ = nullptr;  // FILE*
};

EventFormat native_format();

}  // namespace evbench
