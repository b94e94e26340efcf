#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/events/formats.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

namespace evbench::testing {

inline std::vector<Event> read_all(const std::string& path, const ReadOptions& options = {}) {
  return read_all(*open_events(path, options));
}

struct Sums {
  std::int64_t t = 0, x = 0, y = 0, on = 0;
};

inline Sums sums(const std::vector<Event>& events) {
  Sums sums;
  for (const Event& event : events) {
    sums.t += event.t;
    sums.x += event.x;
    sums.y += event.y;
    sums.on += event.on ? 1 : 0;
  }
  return sums;
}

/// After a seek, reading gives the end of the recording, starting at the first event at or after t or before it.
inline void check_seeking(const std::string& path) {
  const auto reader = open_events(path);
  const std::vector<Event> all = read_all(*reader);
  REQUIRE(all.size() > 1);
  const std::int64_t start = all.front().t, length = all.back().t - start;
  for (const int percent : {50, 0, 93, 100, 10, 37, 101}) {
    CAPTURE(percent);
    const std::int64_t t = start + length * percent / 100;
    reader->seek(t);
    const std::vector<Event> rest = read_all(*reader);
    REQUIRE(rest.size() <= all.size());
    CHECK(std::equal(rest.rbegin(), rest.rend(), all.rbegin()));
    const auto later = [t](const Event& event) { return event.t >= t; };
    CHECK(std::count_if(rest.begin(), rest.end(), later) == std::count_if(all.begin(), all.end(), later));
  }
}

/// A file that is cut short anywhere is refused with a sentence, or gives the beginning of its events and a fault; an
/// error in strict mode.
inline void check_truncation(const TemporaryFolder& folder, const std::string& path, std::size_t places) {
  const std::string whole = read_file(path);
  const std::vector<Event> all = read_all(path);
  std::vector<std::size_t> lengths{1, 4, 15, 16, 17, 40, 100, whole.size() - 1, whole.size() - 9};
  for (std::size_t i = 1; i < places; ++i) lengths.push_back(whole.size() * i / places);
  int read = 0;
  for (const std::size_t length : lengths) {
    CAPTURE(length);
    const std::string cut = folder.write("cut", whole.substr(0, length));
    try {
      const auto reader = open_events(cut);
      const std::vector<Event> events = read_all(*reader);
      REQUIRE(events.size() <= all.size());
      CHECK(std::equal(events.begin(), events.end(), all.begin()));
      CHECK_FALSE(reader->faults().empty());
      ++read;
    } catch (const InputError& error) {
      CHECK(std::string(error.what()).find(folder.path()) == 0);
    }
    ReadOptions strict;
    strict.strict = true;
    CHECK_THROWS_AS(read_all(cut, strict), InputError);
  }
  CHECK(read > 0);
}

/// A file with some bytes changed (to large numbers, too) is read without crashing and without much memory.
inline void check_corruption(const TemporaryFolder& folder, const std::string& path, std::size_t places,
                             std::size_t head) {
  const std::string whole = read_file(path);
  for (std::size_t i = 0; i < places; ++i) {
    // Half of the places among the headers at the beginning.
    const std::size_t at = i % 2 == 0 ? head * i / places : whole.size() / places * i;
    CAPTURE(at);
    std::string broken = whole;
    const char byte = i % 3 == 0 ? '\xFF' : i % 3 == 1 ? '\x7F' : '\0';
    for (std::size_t k = at; k < std::min(at + 3 + i % 6, broken.size()); ++k) broken[k] = byte;
    try {
      const auto reader = open_events(folder.write("broken", broken));
      CHECK(read_all(*reader).size() < 10'000'000);
      reader->seek(0);
    } catch (const InputError& error) {
      CHECK_FALSE(std::string(error.what()).empty());
    }
  }
}

}  // namespace evbench::testing
