// How fast events are read, one thread, warm page cache:
//
//   event_reading FILE...               each file three times; the best counts
//   event_reading --make N FILE.evb     writes a native file of N synthetic events of a 240x180 sensor, 1 million/s
//
// Shows processor time and wall time: the former counts on a machine with other load. "reader" is the format's reader
// alone, "stream" includes the checks that all users get.

#include <fmt/format.h>

#include <cstring>

#include "bench/micro/reading_speed.hpp"
#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/events/native/native.hpp"
#include "core/io/part_file.hpp"
#include "core/support/peak_memory.hpp"

namespace {

using namespace evbench;

void print(const char* what, const Reading& reading) {
  const double millions = static_cast<double>(reading.events) * 1e-6;
  fmt::print("  {:<8} {:>8.1f} million events, {:>7.3f} s ({:>7.3f} s of processor), {:>6.1f} ({:>6.1f}) million/s\n",
             what, millions, reading.wall_s, reading.processor_s, millions / reading.wall_s,
             millions / reading.processor_s);
}

void make(std::int64_t count, const std::string& path) {
  PartFile file(path);
  RecordingHeader header;
  header.width = 240;
  header.height = 180;
  NativeWriter writer(file.writable_path(), header);
  std::vector<Event> events;
  std::uint64_t state = 1;
  for (std::int64_t t = 0; t < count; ++t) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t bits = state >> 32;
    events.push_back({t, static_cast<std::uint16_t>(bits % 240), static_cast<std::uint16_t>((bits >> 8) % 180),
                      (bits >> 20 & 1) != 0});
    if (events.size() == 1 << 16 || t + 1 == count) {
      writer.write(events);
      events.clear();
    }
  }
  writer.finish();
  file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 4 && std::strcmp(argv[1], "--make") == 0) {
      make(std::stoll(argv[2]), argv[3]);
      return 0;
    }
    for (int i = 1; i < argc; ++i) {
      const std::string path = argv[i];
      fmt::print("{} ({})\n", path, open_events(path)->info().format);
      print("reader", measure_reading([&] { return open_events(path); }));
      print("stream", measure_reading([&] { return std::make_unique<EventStream>(path); }));
    }
    fmt::print("peak memory: {:.0f} MiB\n", peak_memory_mib());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "event_reading: {}\n", error.what());
    return 2;
  }
}
