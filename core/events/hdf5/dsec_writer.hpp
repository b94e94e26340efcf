#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/events/hdf5/file.hpp"
#include "core/events/writer.hpp"

namespace evbench {

/// HDF5 in DSEC's layout (Gehrig et al. 2021): /events/t (uint32, [µs] since t_offset), /events/x, /events/y (uint16),
/// /events/p (uint8), /ms_to_idx (index of the first event at or after each millisecond), /t_offset (int64 [µs]: the
/// first event's time). Compressed by deflate with shuffling, which every HDF5 library reads. The sensor's size is in
/// the attributes width and height of /events: DSEC itself has no place for it.
/// Throws InputError for more than 71 min, the range of 32 bits.
class DsecWriter : public EventWriter {
 public:
  /// `name`: the file's, for messages.
  DsecWriter(const std::string& path, std::string name, const RecordingHeader& header);

  void write(std::span<const Event> events) override;
  void finish() override;

 private:
  /// A growing array of the file.
  struct Column {
    hdf5::Handle id;
    std::int64_t type = 0;  ///< of the numbers passed in
  };
  Column make_column(const std::string& name, std::int64_t stored_type, std::int64_t type) const;
  void append(const Column& column, std::uint64_t first, const void* numbers, std::size_t count) const;
  std::int64_t check(std::int64_t id) const;  ///< throws for what the library couldn't do

  std::string name_;
  hdf5::Handle file_, events_;
  Column t_, x_, y_, p_;
  std::vector<std::uint64_t> ms_to_idx_;
  std::int64_t offset_ = 0;  ///< [µs]
  std::uint64_t count_ = 0;
};

}  // namespace evbench
