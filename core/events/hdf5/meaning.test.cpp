#include <algorithm>
#include <string>
#include <vector>

#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/events/testing/hdf5_writer.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using testing::read_all;

namespace {

/// 2,000 events within 2 s in columns of these times and polarities.
template <class Time, class Polarity = std::uint8_t>
std::string write_times(const testing::TemporaryFolder& folder, Time start, double step, const std::string& unit = "",
                        const std::vector<Polarity>& polarities = {}) {
  const std::string path = folder.file("times.h5");
  testing::Hdf5Writer file(path);
  std::vector<std::uint16_t> pixels(2000);
  std::vector<Time> t;
  std::vector<Polarity> p(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint16_t>(i % 100);
    t.push_back(static_cast<Time>(static_cast<double>(start) + step * static_cast<double>(i)));
    p[i] = polarities.empty() ? static_cast<Polarity>(i % 2) : polarities[i % polarities.size()];
  }
  file.add("events/x", pixels);
  file.add("events/y", pixels);
  file.add("events/t", t);
  file.add("events/p", p);
  if (!unit.empty()) file.add_attribute("events/t", "units", unit);
  return path;
}

double seconds_of(const std::string& path, const std::string& columns = "") {
  EventStream stream(path, {.read = {.columns = columns}});
  const auto events = read_all(stream);
  REQUIRE(events.size() == 2000);
  return 1e-6 * static_cast<double>(events.back().t - events.front().t);
}

}  // namespace

TEST_CASE("HDF5 times are of the unit that is asked for, that an attribute says, or that fits them") {
  const testing::TemporaryFolder folder;
  CHECK(seconds_of(write_times<std::int64_t>(folder, 0, 1000)) == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<double>(folder, 0.25, 0.001)) == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<double>(folder, 1e15, 1000)) == Approx(2).margin(0.01));  // whole: microseconds
  CHECK(seconds_of(write_times<std::int64_t>(folder, 0, 1e6, "ns")) == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<std::int64_t>(folder, 0, 1, "Milliseconds")) == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<double>(folder, 0.5, 1000, "\xC2\xB5s")) == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<std::int64_t>(folder, 0, 1e6, "s"), "t_ns,x,y,p") == Approx(2).margin(0.01));
  CHECK(seconds_of(write_times<std::uint64_t>(folder, 0, 1e6, "?"), "x,y,p,t_ns") == Approx(2).margin(0.01));
  const auto reader = open_events(write_times<std::int64_t>(folder, 1'700'000'000'000'000'600, 1e6, "[ns]"));
  CHECK(reader->info().start == 1'700'000'000'000'001);
}

TEST_CASE("HDF5 times that can't be of the unit that was guessed are refused with the option that says it") {
  const testing::TemporaryFolder folder;
  const std::string nanoseconds = write_times<std::int64_t>(folder, 1'500'000'000'000'000'000, 1e6);
  CHECK_THROWS_WITH(open_events(nanoseconds),
                    Catch::Matchers::ContainsSubstring("too late for microseconds") &&
                        Catch::Matchers::ContainsSubstring("t_ns,x,y,p makes it the year 2017, not 49503"));
  CHECK(seconds_of(nanoseconds, "t_ns,x,y,p") == Approx(2).margin(0.01));
  CHECK_THROWS_WITH(
      open_events(write_times<double>(folder, 0.5, 1000)),
      Catch::Matchers::ContainsSubstring("are the times seconds? In microseconds (--columns t_us,x,y,p)"));
  CHECK_THROWS_WITH(open_events(write_times<double>(folder, 1.5e12 + 0.5, 1)),
                    Catch::Matchers::ContainsSubstring("too late for seconds"));
  CHECK_THROWS_WITH(open_events(write_times<std::int64_t>(folder, 0, 1000, "ticks")),
                    Catch::Matchers::ContainsSubstring("/events/t: attribute units is \"ticks\"; expected s, ms"));
  CHECK_THROWS_WITH(open_events(nanoseconds, {.columns = "t_ns,x"}),
                    Catch::Matchers::ContainsSubstring("names the columns \"t_ns,x\""));
}

TEST_CASE("HDF5 polarities that can mean one thing only are read") {
  const testing::TemporaryFolder folder;
  const auto on = [&]<class P>(const std::vector<P>& polarities) {
    const auto events = read_all(*open_events(write_times<std::int64_t, P>(folder, 0, 1000, "", polarities)));
    CHECK(events.size() == 2000);
    return std::ranges::count_if(events, &Event::on);
  };
  CHECK(on(std::vector<std::uint8_t>{0, 1}) == 1000);
  CHECK(on(std::vector<std::int8_t>{-1, 1, 1, 1}) == 1500);
  CHECK(on(std::vector<std::uint8_t>{255, 1, 1, 1}) == 1500);
  CHECK(on(std::vector<std::uint16_t>{65535, 1}) == 1000);
  CHECK(on(std::vector<std::uint32_t>{4294967295, 1}) == 1000);
  CHECK(on(std::vector<std::uint32_t>{255, 1}) == 1000);
  CHECK(on(std::vector<std::uint64_t>{~std::uint64_t{0}, 1}) == 1000);
  CHECK(on(std::vector<double>{-1, 1}) == 1000);
  CHECK(on(std::vector<std::uint8_t>{1}) == 2000);
  CHECK(on(std::vector<std::uint8_t>{255}) == 0);
}

TEST_CASE("HDF5 polarities that may mean several things are counted and refused") {
  const testing::TemporaryFolder folder;
  const auto refused = [&]<class P>(const std::vector<P>& polarities, const std::string& sentence) {
    const std::string path = write_times<std::int64_t, P>(folder, 0, 1000, "", polarities);
    EventStream stream(path);
    CHECK_THROWS_WITH(read_all(stream), Catch::Matchers::ContainsSubstring(sentence));
  };
  refused(std::vector<std::uint8_t>{1, 2},
          "1000 of 2000, have to be left out, most of them as events whose polarity is "
          "neither 0 nor 1 (the first: row 1)");
  refused(std::vector<std::uint8_t>{0, 1, 2, 3}, "neither 0 nor 1");
  refused(std::vector<std::uint8_t>{0, 255}, "neither 0 nor 1");
  refused(std::vector<std::int8_t>{-1, -1, 0}, "neither -1 nor 1");
  refused(std::vector<double>{0, 0.5}, "neither 0 nor 1");
  std::vector<std::uint8_t> late(2000, 1);
  late[1990] = 7;
  const std::string path = write_times<std::int64_t, std::uint8_t>(folder, 0, 1000, "", late);
  const auto reader = open_events(path);
  CHECK(read_all(*reader).size() == 1999);
  CHECK(reader->faults().all().begin()->second.first == "row 1990");
  CHECK_THROWS_AS(read_all(*open_events(path, {.strict = true})), InputError);
}

TEST_CASE("HDF5 rows are read in whatever order their columns are") {
  const testing::TemporaryFolder folder;
  const std::vector<Event> expected{{1000, 5, 8, true}, {2000, 107, 6, false}, {3000, 9, 200, true}};
  const auto read = [&](const std::vector<std::uint32_t>& rows, hsize_t columns, const ReadOptions& options = {}) {
    const std::string path = folder.file("rows.h5");
    {
      testing::Hdf5Writer file(path);
      file.add("events", rows, columns);
    }
    const auto reader = open_events(path, options);
    CHECK(reader->info().metadata.at(1).first == "columns");
    return read_all(*reader);
  };
  CHECK(read({1000, 5, 8, 1, 2000, 107, 6, 0, 3000, 9, 200, 1}, 4) == expected);
  CHECK(read({5, 8, 1, 1000, 107, 6, 0, 2000, 9, 200, 1, 3000}, 4) == expected);
  CHECK(read({5, 8, 1000, 1, 107, 6, 2000, 0, 9, 200, 3000, 1}, 4) == expected);
  CHECK(read({7, 1, 5, 8, 1, 7, 2, 107, 6, 0, 7, 3, 9, 200, 1}, 5, {.columns = "-,t_ms,x,y,p"}) == expected);
  CHECK_THROWS_WITH(read({1, 1, 1, 1}, 4), Catch::Matchers::ContainsSubstring("may be \"t x y p\" and \"x y t p\"; "
                                                                              "give --columns"));
  CHECK_THROWS_WITH(read({5, 6, 7, 8}, 4), Catch::Matchers::ContainsSubstring("/events: has lines like \"5 6 7 8\""));
  CHECK_THROWS_WITH(read({5, 6, 7, 8}, 4, {.columns = "t,x,y,p,other"}),
                    Catch::Matchers::ContainsSubstring("expected rows of 5 numbers: t x y p -"));
}

TEST_CASE("Metavision's HDF5 is refused by its name") {
  const testing::TemporaryFolder folder;
  {
    testing::Hdf5Writer file(folder.file("metavision.h5"));
    file.add_compound("CD/events", 0x8ECF);
    testing::Hdf5Writer plain(folder.file("plain.h5"));
    plain.add_compound("events", 0);
  }
  CHECK_THROWS_WITH(open_events(folder.file("metavision.h5")),
                    Catch::Matchers::ContainsSubstring("/CD/events: is a compound type (x, y, p, t), as Metavision "
                                                       "writes it, compressed with its ECF filter"));
  CHECK_THROWS_WITH(open_events(folder.file("plain.h5")), Catch::Matchers::ContainsSubstring("is a compound type"));
}

TEST_CASE("HDF5 files from other sources are read correctly, or refused") {
  if (const auto path = testing::data_file("cases/hdf5_polarity/p_wrap32.h5")) {
    const auto events = read_all(*open_events(*path));
    CHECK(events.size() == 20'000);
    CHECK(std::ranges::count_if(events, &Event::on) == 10'026);
  }
  if (const auto path = testing::data_file("cases/hdf5_times/int_ns_epoch.h5")) {
    CHECK_THROWS_WITH(open_events(*path), Catch::Matchers::ContainsSubstring("too late for microseconds"));
    const auto reader = open_events(*path, {.columns = "t_ns,x,y,p"});
    CHECK(*reader->info().end - *reader->info().start == Approx(2e6).margin(1e4));
  }
}
