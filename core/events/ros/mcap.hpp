#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/events/formats.hpp"
#include "core/events/ros/message_source.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// MCAP, ROS 2's container (https://mcap.dev/spec): records, most of them in chunks (plain, lz4, zstd), with topics,
/// counts and an index of chunks at the end. Without that end all is read once for the topics.
class McapBag : public ros::MessageSource {
 public:
  McapBag(std::unique_ptr<ByteSource> file, Faults& faults);
  static bool is_mcap(std::span<const std::byte> head);

  const std::vector<ros::Topic>& topics() const override { return topics_; }
  void select(std::set<std::uint32_t> topics) override;
  std::optional<ros::Message> next() override;
  void seek(std::int64_t t) override;

 private:
  enum class Op : std::uint8_t {
    footer = 0x02,
    schema = 0x03,
    channel = 0x04,
    message = 0x05,
    chunk = 0x06,
    chunk_index = 0x08,
    statistics = 0x0B,
    data_end = 0x0F,
  };
  struct Record {
    Op op = {};
    std::span<const std::byte> data;
    std::uint64_t end = 0;  ///< offset
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic, encoding;
  };
  struct ChunkInfo {
    std::uint64_t offset = 0, end = 0;  ///< end: time [ns]
  };

  bool read_record(std::uint64_t offset, Record& record);
  bool read_summary();
  void scan();
  bool note(Op op, std::span<const std::byte> data);
  void go_to(std::uint64_t offset);
  std::optional<ros::Message> next_of_all();
  std::optional<ros::Message> take(Op op, std::span<const std::byte> data);
  bool load_chunk(std::span<const std::byte> data);
  std::string place() const { return "byte " + std::to_string(at_); }

  std::unique_ptr<ByteSource> file_;
  Faults& faults_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< messages of channels
  std::vector<ChunkInfo> chunks_;
  std::vector<ros::Topic> topics_;
  std::set<std::uint32_t> selected_;

  std::vector<std::byte> data_;  ///< of the last record of the file
  std::vector<std::byte> unpacked_;
  std::span<const std::byte> chunk_;  ///< its records, in one of these two
  std::size_t used_ = 0;              ///< of the chunk
  std::uint64_t at_ = 0;              ///< next record of the file
  std::uint64_t end_ = 0;             ///< of the records with messages
};

EventFormat mcap_format();

}  // namespace evbench
