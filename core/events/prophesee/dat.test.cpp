#include "core/events/prophesee/dat.hpp"

#include "core/events/formats.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

using Words = std::vector<std::uint32_t>;

const std::string kDatHeader2 = "% Data file containing CD events.\n% Version 2\n% Height 720\n% Width 1280\n";
const std::string kHeader1 = "% Data file containing TD events.\n";
const std::string kChanges("\x0C\x08", 2), kChanges1("\x00\x08", 2);

std::unique_ptr<EventReader> dat(const std::string& content, const ReadOptions& options = {}) {
  return open_dat(bytes_of(content), options);
}

}  // namespace

TEST_CASE("DAT files of both versions decode, with the sensor's size and the count") {
  const auto two = dat(kDatHeader2 + kChanges + data_of(Words{5, 1279 | 719 << 14 | 1 << 28, 6, 3 | 4 << 14}));
  CHECK((read_all(*two) == std::vector<Event>{{5, 1279, 719, true}, {6, 3, 4, false}}));
  CHECK(two->info().width == 1280);
  CHECK(two->info().height == 720);
  CHECK(two->info().count == 2);
  const auto one = dat(kHeader1 + kChanges1 + data_of(Words{5, 303 | 239 << 9 | 1 << 17, 6, 3 | 4 << 9}));
  CHECK((read_all(*one) == std::vector<Event>{{5, 303, 239, true}, {6, 3, 4, false}}));
  CHECK(one->info().width == 0);
}

TEST_CASE("DAT times count on when their 32 bits are used up, and may step back a little") {
  const auto reader = dat(kDatHeader2 + kChanges + data_of(Words{0xFFFFFFFE, 0, 0xFFFFFFFD, 0, 3, 0}));
  const auto events = read_all(*reader);
  REQUIRE(events.size() == 3);
  CHECK(events[1].t == 0xFFFFFFFD);
  CHECK(events[2].t == 0x100000003);
}

TEST_CASE("A DAT time that is wrong does not move the events after it") {
  const auto reader = dat(kDatHeader2 + kChanges + data_of(Words{10, 0, 0xF0000000, 0, 11, 0}));
  const auto events = read_all(*reader);
  REQUIRE(events.size() == 3);
  CHECK(events[2].t == 11);
  CHECK(fault_counts(*reader) == std::vector<std::int64_t>{1});
}

TEST_CASE("DAT files of other versions and events, without pixels, or without a header are refused") {
  CHECK_THROWS_AS(dat(""), InputError);
  CHECK_THROWS_AS(dat(kDatHeader2), InputError);
  CHECK_THROWS_AS(dat(kDatHeader2 + "\x0C"), InputError);
  CHECK_THROWS_AS(dat(kDatHeader2 + "\x0E\x08"), InputError);
  CHECK_THROWS_AS(dat(kDatHeader2 + "\x0C\x10"), InputError);
  CHECK_THROWS_AS(dat("% Version 3\n" + kChanges), InputError);
  CHECK_THROWS_AS(dat("% Version 2\n% Width 0\n% Height 10\n" + kChanges), InputError);
  CHECK_THROWS_AS(dat("% Version 2\n% Width 10\n" + kChanges), InputError);
}

TEST_CASE("A DAT file is recognised by its content") {
  const TemporaryFolder folder;
  const auto path = folder.write("events", kDatHeader2 + kChanges + data_of(Words{5, 1}));
  const auto reader = open_events(path);
  CHECK(reader->info().format == "Prophesee DAT 2");
  CHECK(read_all(*reader).size() == 1);
}

TEST_CASE("DAT files truncated anywhere, or with any bytes, are read as far as they go") {
  std::string content = kDatHeader2 + kChanges;
  for (std::uint32_t i = 0; i < 500; ++i) content += data_of(Words{i, i | i << 14});
  check_survives(content, [](const std::string& bytes) { return dat(bytes); });
  const auto reader = dat(content + "xyz");
  CHECK(read_all(*reader).size() == 500);
  CHECK(fault_counts(*reader) == std::vector<std::int64_t>{1});
}
