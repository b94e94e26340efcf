#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/events/formats.hpp"
#include "core/events/ros/chunk_order.hpp"
#include "core/events/ros/message_source.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// MCAP, ROS 2's container (https://mcap.dev/spec): records, most of them in chunks (plain, lz4, zstd), and a summary
/// at the end with topics, counts and an index of chunks. Without the summary the whole file is read once for topics
/// and times.
class McapBag : public ros::MessageSource {
 public:
  McapBag(std::unique_ptr<ByteSource> file, Faults& faults);
  static bool is_mcap(std::span<const std::byte> head);

  const std::vector<ros::Connection>& connections() const override { return connections_; }
  void select(std::set<std::uint32_t> connections) override {
    selected_ = std::move(connections);
    order_.begin(chunks_);
  }
  std::optional<ros::Message> next() override { return order_.next(); }
  void seek(std::int64_t t) override { order_.begin(chunks_, t); }

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

  bool read_record(std::uint64_t offset, Record& record, std::uint64_t most);
  bool read_summary();
  bool parse(Op op, std::span<const std::byte> data);
  void find_chunks();
  void add_message(std::uint64_t offset, const Record& record);
  static bool read_times(std::span<const std::byte> data, ros::Chunk& chunk);
  bool scan(ros::Chunk& chunk);
  void load_chunk(const ros::Chunk& chunk, ros::LoadedChunk& content);
  std::span<const std::byte> unpack(const ros::Chunk& chunk, std::vector<std::byte>& bytes);
  std::optional<std::span<const std::byte>> decompress(std::vector<std::byte>& bytes);

  std::unique_ptr<ByteSource> file_;
  Faults& faults_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;  ///< messages of channels
  bool counted_ = true;                            ///< counts_ is complete
  bool summarised_ = false;                        ///< these and the index are from the file's summary
  std::set<std::uint64_t> index_;                  ///< offsets of chunks
  std::uint64_t end_ = 0;                          ///< of the records with messages
  std::uint64_t run_ = 0;                          ///< offset of the last run
  std::vector<ros::Chunk> chunks_;                 ///< and runs of messages outside of chunks, each as one
  std::vector<ros::Connection> connections_;
  std::set<std::uint32_t> selected_;
  std::vector<std::byte> data_;  ///< of the last record of the file
  ros::ChunkOrder order_;
};

EventFormat mcap_format();

}  // namespace evbench
