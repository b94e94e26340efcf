// How fast each format is read, one thread, warm page cache:
//
//   events_micro [MILLIONS]     writes files of that many million random events (10) to a temporary folder, and reads
//                               each three times; the best counts
//
// "reader" is the format's reader alone, "stream" includes the checks that all users get; both in million events a
// second, by wall time and by processor time.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/micro/reading_speed.hpp"
#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/support/peak_memory.hpp"

namespace {

using namespace evbench;

template <class T>
void append(std::string& out, T number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof(T));
}

/// Writes events in one format, one after the other.
struct Format {
  const char* name;
  std::string header;
  void (*write)(std::string& out, const Event& event, const Event& before);
};

void write_text(std::string& out, const Event& event, const Event&) {
  fmt::format_to(std::back_inserter(out), "{}.{:06}000 {} {} {:d}\n", event.t / 1'000'000, event.t % 1'000'000, event.x,
                 event.y, event.on);
}

void write_csv(std::string& out, const Event& event, const Event&) {
  fmt::format_to(std::back_inserter(out), "{},{},{:d},{}\n", event.x, event.y, event.on, event.t);
}

void write_evt2(std::string& out, const Event& event, const Event& before) {
  const auto t = static_cast<std::uint32_t>(event.t);
  if (event.t == 0 || event.t >> 6 != before.t >> 6) append(out, 0x80000000u | t >> 6);
  append(out, static_cast<std::uint32_t>(event.on) << 28 | (t & 0x3F) << 22 | std::uint32_t{event.x} << 11 | event.y);
}

/// Eight neighbours in a word.
void write_evt21(std::string& out, const Event& event, const Event& before) {
  const auto t = static_cast<std::uint64_t>(event.t);
  if (event.t == 0 || event.t >> 6 != before.t >> 6) append(out, (0x80000000u | t >> 6) << 32);
  append(out, (std::uint64_t{event.on} << 28 | (t & 0x3F) << 22 | std::uint64_t{event.x} << 11 | event.y) << 32 | 0xFF);
}

void write_evt3_state(std::string& out, const Event& event, const Event& before) {
  const auto t = static_cast<std::uint32_t>(event.t);
  const bool first = event.t == 0;
  if (first || event.t >> 12 != before.t >> 12) append(out, static_cast<std::uint16_t>(0x8000 | (t >> 12 & 0xFFF)));
  if (first || event.t != before.t) append(out, static_cast<std::uint16_t>(0x6000 | (t & 0xFFF)));
  if (first || event.y != before.y) append(out, event.y);
}

void write_evt3(std::string& out, const Event& event, const Event& before) {
  write_evt3_state(out, event, before);
  append(out, static_cast<std::uint16_t>(0x2000 | event.on << 11 | event.x));
}

/// Eight neighbours in a word.
void write_evt3_vectors(std::string& out, const Event& event, const Event& before) {
  write_evt3_state(out, event, before);
  append(out, static_cast<std::uint16_t>(0x3000 | event.on << 11 | event.x));
  append(out, std::uint16_t{0x4F0F});
}

void write_dat(std::string& out, const Event& event, const Event&) {
  append(out, static_cast<std::uint32_t>(event.t));
  append(out, static_cast<std::uint32_t>(event.on) << 28 | std::uint32_t{event.y} << 14 | event.x);
}

void write_es(std::string& out, const Event& event, const Event& before) {
  append(out, static_cast<std::uint8_t>((event.t - before.t) << 1 | event.on));
  append(out, event.x);
  append(out, event.y);
}

const Format kFormats[] = {
    {"text, seconds", "", write_text},
    {"text, CSV in us", "", write_csv},
    {"EVT 2", "% evt 2.0\n% geometry 240x180\n", write_evt2},
    {"EVT 2.1, vectors", "% evt 2.1\n% geometry 240x180\n", write_evt21},
    {"EVT 3, no vectors", "% evt 3.0\n% geometry 240x180\n", write_evt3},
    {"EVT 3, vectors", "% evt 3.0\n% geometry 240x180\n", write_evt3_vectors},
    {"DAT", std::string("% Version 2\n% Height 180\n% Width 240\n\x0C\x08", 39), write_dat},
    {"Event Stream", std::string("Event Stream\2\0\0\1\xF0\0\xB4\0", 20), write_es},
};

/// Four events a microsecond, anywhere on the sensor.
void write_file(const Format& format, std::int64_t count, const std::string& path) {
  constexpr std::size_t kPiece = 1 << 20;
  std::ofstream file(path, std::ios::binary);
  std::string out = format.header;
  std::uint64_t state = 1;
  Event before;
  for (std::int64_t i = 0; i < count; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t bits = state >> 33;
    const Event event{i / 4, static_cast<std::uint16_t>(bits % 228), static_cast<std::uint16_t>((bits >> 8) % 180),
                      (bits >> 20 & 1) != 0};
    format.write(out, event, before);
    before = event;
    if (out.size() > kPiece || i + 1 == count) {
      file.write(out.data(), static_cast<std::streamsize>(out.size()));
      out.clear();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::int64_t count = (argc > 1 ? std::atoll(argv[1]) : 10) * 1'000'000;
  const std::string path =
      fmt::format("{}/events_micro-{}", std::filesystem::temp_directory_path().string(), ::getpid());
  fmt::print("{:<20} {:>10} {:>12} {:>12} {:>12} {:>12}\n", "format", "bytes", "reader", "(processor)", "stream",
             "(processor)");
  for (const Format& format : kFormats) {
    write_file(format, count, path);
    const Reading reader = measure_reading([&] { return open_events(path); });
    const Reading stream = measure_reading([&] { return std::make_unique<EventStream>(path); });
    const auto millions = static_cast<double>(reader.events) * 1e-6;
    fmt::print("{:<20} {:>10.2f} {:>12.1f} {:>12.1f} {:>12.1f} {:>12.1f}\n", format.name,
               static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(reader.events),
               millions / reader.wall_s, millions / reader.processor_s, millions / stream.wall_s,
               millions / stream.processor_s);
    std::filesystem::remove(path);
  }
  fmt::print("bytes: of an event. Peak memory: {:.0f} MiB\n", peak_memory_mib());
}
