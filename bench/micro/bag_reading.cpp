// Speed of reading bags, compared with their own libraries; one thread, warm page cache, the best of three:
//
//   bag_reading FILE...        ROS 1 bags, ROS 2 bags in SQLite, MCAP files
//
// The first row is the cost of the container alone: a plain SELECT for SQLite, reading and decompressing the chunks for
// MCAP. "evbench, bytes" gives the same bytes by evbench's reader of the container, "evbench, events" decodes messages'
// bytes to events, as users get them. Percentages are of the speed in the first row, by processor time.

#include <fmt/format.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "bench/micro/reading_speed.hpp"
#include "core/events/bytes/byte_cursor.hpp"
#include "core/events/formats.hpp"
#include "core/events/ros/mcap.hpp"
#include "core/events/ros/ros1_bag.hpp"
#include "core/events/ros/ros2_sqlite.hpp"
#include "core/support/error.hpp"

namespace {

using namespace evbench;

/// The output of reading a bag. Every cache line of it is touched, so that no method gains by skipping pages.
struct Delivered {
  std::int64_t messages = 0, bytes = 0;
  std::uint64_t sum = 0;

  void add(std::span<const std::byte> message) {
    constexpr std::size_t kLine = 64;
    ++messages;
    bytes += static_cast<std::int64_t>(message.size());
    for (std::size_t i = 0; i < message.size(); i += kLine) sum += static_cast<std::uint64_t>(message[i]);
  }
};

/// A method of reading a bag to its end.
struct WayToRead {
  std::string name;
  std::function<Delivered()> read;
};

/// Messages through evbench's reader of a container, all topics.
Delivered read_messages(ros::MessageSource& source) {
  std::set<std::uint32_t> all;
  for (const ros::Connection& connection : source.connections()) all.insert(connection.id);
  source.select(all);
  Delivered delivered;
  while (const auto message = source.next()) delivered.add(message->data);
  return delivered;
}

Delivered read_with_sqlite(const std::string& path) {
  sqlite3* database = nullptr;
  sqlite3_stmt* query = nullptr;
  if (sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK ||
      sqlite3_prepare_v2(database, "SELECT data FROM messages", -1, &query, nullptr) != SQLITE_OK) {
    throw InputError(fmt::format("{}: {}", path, sqlite3_errmsg(database)));
  }
  Delivered delivered;
  while (sqlite3_step(query) == SQLITE_ROW) {
    const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(query, 0));
    delivered.add({data, static_cast<std::size_t>(sqlite3_column_bytes(query, 0))});
  }
  sqlite3_finalize(query);
  sqlite3_close(database);
  return delivered;
}

/// A whole chunk at once; the number of bytes made.
std::size_t unpack_chunk(const std::string& compression, std::span<const std::byte> packed, std::span<std::byte> out) {
  if (compression == "zstd") return ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
  if (compression != "lz4") return packed.size();
  LZ4F_dctx* context = nullptr;
  LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  std::size_t made = out.size(), taken = packed.size();
  LZ4F_decompress(context, out.data(), &made, packed.data(), &taken, nullptr);
  LZ4F_freeDecompressionContext(context);
  return made;
}

/// The chunks of an MCAP file, unpacked; messages outside chunks are ignored.
Delivered read_chunks(const std::string& path) {
  constexpr std::size_t kMagic = 8, kHeader = 9;
  constexpr std::byte kChunk{6};
  FileBytes file(path);
  std::vector<std::byte> record, chunk;
  Delivered delivered;
  for (std::uint64_t at = kMagic; at + kHeader <= file.size();) {
    std::byte header[kHeader];
    file.read(at, header);
    const auto size = load<std::uint64_t>(header + 1);
    if (header[0] == kChunk) {
      record.resize(size);
      file.read(at + kHeader, record);
      ByteCursor cursor(record);
      cursor.bytes(2 * 8);
      chunk.resize(cursor.get<std::uint64_t>());
      cursor.get<std::uint32_t>();
      const std::string compression = cursor.text(cursor.get<std::uint32_t>());
      const auto packed = cursor.bytes(cursor.get<std::uint64_t>());
      const std::size_t made = unpack_chunk(compression, packed, chunk);
      delivered.add(compression.empty() ? packed : std::span<const std::byte>(chunk).first(made));
    }
    at += kHeader + size;
  }
  return delivered;
}

/// The container alone first, where it can be measured separately, then evbench.
std::vector<WayToRead> ways_to_read(const std::string& path) {
  const auto by_evbench = [path](auto open) {
    return WayToRead{"evbench, bytes", [path, open] {
                       Faults faults(path, false);
                       return read_messages(*open(faults));
                     }};
  };
  const StreamInfo info = open_events(path)->info();
  std::vector<WayToRead> ways;
  if (info.format == "ROS 1 bag") {
    ways.push_back(by_evbench(
        [path](Faults& faults) { return std::make_unique<RosBag>(std::make_unique<FileBytes>(path), faults); }));
  } else if (info.format == "MCAP") {
    ways.push_back({"chunks alone", [path] { return read_chunks(path); }});
    ways.push_back(by_evbench(
        [path](Faults& faults) { return std::make_unique<McapBag>(std::make_unique<FileBytes>(path), faults); }));
  } else if (info.format == "ROS 2 bag (SQLite)") {
    ways.push_back({"library, SELECT", [path] { return read_with_sqlite(path); }});
    ways.push_back(by_evbench([path](Faults& faults) { return open_sqlite_bag(path, faults, true); }));
  } else {
    throw InputError(fmt::format("{}: is {}; expected a bag in one file", path, info.format));
  }
  return ways;
}

/// Processor time of the best of three.
double seconds_for(const std::function<void()>& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double start = processor_seconds();
    work();
    best = std::min(best, processor_seconds() - start);
  }
  return best;
}

void compare(const std::string& path) {
  fmt::print("{}\n  {:<20} {:>10} {:>10} {:>12} {:>14} {:>10}\n", path, "", "MB", "processor s", "messages MB/s",
             "million/s", "of library");
  double megabytes = 0.0;  // of messages
  std::optional<double> library_s;
  const auto print = [&](const std::string& name, double seconds, const std::string& millions) {
    fmt::print("  {:<20} {:>10.1f} {:>12.4f} {:>14.0f} {:>10} {:>10}\n", name, megabytes, seconds, megabytes / seconds,
               millions, library_s ? fmt::format("{:.0f} %", 100.0 * *library_s / seconds) : "");
  };
  for (const WayToRead& way : ways_to_read(path)) {
    Delivered delivered;
    const double seconds = seconds_for([&] { delivered = way.read(); });
    if (megabytes == 0.0) megabytes = 1e-6 * static_cast<double>(delivered.bytes);
    if (way.name != "evbench, bytes") library_s = seconds;
    print(way.name, seconds, "");
  }
  const Reading events = measure_reading([&] { return open_events(path); });
  print("evbench, events", events.processor_s,
        fmt::format("{:.1f}", 1e-6 * static_cast<double>(events.events) / events.processor_s));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) compare(argv[i]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bag_reading: {}\n", error.what());
    return 2;
  }
}
