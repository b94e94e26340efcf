#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/events/bytes/bytes.hpp"
#include "core/events/formats.hpp"
#include "core/events/ros/chunk_order.hpp"
#include "core/events/ros/message_source.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// A record of a bag: a header of fields name=value, and data.
struct BagRecord {
  std::map<std::string, std::span<const std::byte>, std::less<>> fields;
  std::uint64_t data = 0;  ///< offset
  std::uint32_t size = 0;  ///< of the data

  template <class T>
  T number(std::string_view name) const {
    const auto field = fields.find(name);
    return field == fields.end() || field->second.size() != sizeof(T) ? T{} : load<T>(field->second.data());
  }
  std::string text(std::string_view name) const {
    const auto field = fields.find(name);
    if (field == fields.end()) return "";
    return {reinterpret_cast<const char*>(field->second.data()), field->second.size()};
  }
  unsigned op() const { return number<std::uint8_t>("op"); }
};

/// ROS's bag format 2.0 (http://wiki.ros.org/Bags/Format/2.0). Chunks are found by the lengths of the records, and
/// their times by the index. A chunk that the index does not name is read for its times first; without an index all
/// chunks are.
///
/// It is used in place of librosbag_storage 1.15, which refuses bags that are cut short or were not closed, follows the
/// offsets of the index and the lengths in headers without checks, and allocates what a length states. Of 20,000 copies
/// of a bag of 15 kB with one to four bytes changed, 396 ended the program with SIGSEGV and 145 made it allocate more
/// than 256 MiB. This reader is as fast (bench/micro/bag_reading.cpp).
class RosBag : public ros::MessageSource {
 public:
  RosBag(std::unique_ptr<ByteSource> file, Faults& faults);

  const std::vector<ros::Connection>& connections() const override { return connections_; }
  void select(std::set<std::uint32_t> connections) override {
    selected_ = std::move(connections);
    order_.begin(chunks_);
  }
  std::optional<ros::Message> next() override { return order_.next(); }
  void seek(std::int64_t t) override { order_.begin(chunks_, t); }

 private:
  using Index = std::map<std::uint64_t, ros::Chunk>;  ///< by their offsets

  bool read_record(std::uint64_t offset, BagRecord& record);
  bool read_data(const BagRecord& record, std::vector<std::byte>& data);
  bool read_index(std::uint64_t offset, std::uint32_t chunks, Index& index);
  void find_chunks(const Index& index, std::uint64_t end);
  bool scan(ros::Chunk& chunk);
  void load_chunk(const ros::Chunk& chunk, ros::LoadedChunk& content);
  bool unpack(std::uint64_t offset, std::vector<std::byte>& chunk);
  void add_connection(const BagRecord& record, std::span<const std::byte> data);
  void count(std::uint32_t connection, std::uint64_t messages);

  std::unique_ptr<ByteSource> file_;
  Faults& faults_;
  std::vector<ros::Connection> connections_;
  std::set<std::uint32_t> selected_;
  std::vector<ros::Chunk> chunks_;
  std::vector<std::byte> header_, packed_;
  ros::ChunkOrder order_;
};

EventFormat ros1_bag_format();

}  // namespace evbench
