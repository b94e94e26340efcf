#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/events/bytes/bytes.hpp"
#include "core/events/formats.hpp"
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

/// ROS's bag format 2.0 (http://wiki.ros.org/Bags/Format/2.0). Read by ourselves, as librosbag_storage 1.15 refuses
/// bags that are cut short or were not closed, reads where the index and the lengths within headers point to without
/// comparing that with what there is, and allocates what a length says: of 20,000 copies of a bag of 15 kB with one to
/// four bytes changed, 396 ended the program with SIGSEGV and 145 made it allocate more than 256 MiB. To guard it, one
/// would have to parse every record before; this reader is no more than that, and as fast
/// (bench/micro/bag_reading.cpp).
class RosBag : public ros::MessageSource {
 public:
  RosBag(std::unique_ptr<ByteSource> file, Faults& faults);

  const std::vector<ros::Topic>& topics() const override { return topics_; }
  void select(std::set<std::uint32_t> topics) override {
    selected_ = std::move(topics);
    go_to(kBegin);
  }
  std::optional<ros::Message> next() override;
  void seek(std::int64_t t) override;

 private:
  static constexpr std::uint64_t kBegin = 13;  ///< of the records, behind the magic bytes
  struct ChunkInfo {
    std::uint64_t offset = 0;
    std::int64_t end = 0;  ///< [ns]
  };

  void go_to(std::uint64_t offset) {
    at_ = offset;
    chunk_.clear();
    used_ = 0;
  }
  bool read_record(std::uint64_t offset, BagRecord& record);
  bool read_data(const BagRecord& record, std::vector<std::byte>& data);
  bool read_index(std::uint64_t offset, std::uint32_t chunks);
  void scan();
  bool next_chunk();
  bool load_chunk(const BagRecord& record);
  std::optional<ros::Message> next_in_chunk();
  void add_topic(const BagRecord& record, std::span<const std::byte> data);
  void count(std::uint32_t connection, std::uint64_t messages);
  std::string place() const { return "byte " + std::to_string(at_); }

  std::unique_ptr<ByteSource> file_;
  Faults& faults_;
  std::vector<ros::Topic> topics_;
  std::set<std::uint32_t> selected_;
  std::vector<ChunkInfo> chunks_;
  std::vector<std::byte> header_, packed_, chunk_;
  std::size_t used_ = 0;   ///< of the chunk
  std::uint64_t at_ = 0;   ///< next record of the file
  std::uint64_t end_ = 0;  ///< of the chunks
};

EventFormat ros1_bag_format();

}  // namespace evbench
