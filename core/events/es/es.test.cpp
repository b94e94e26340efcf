#include "core/events/es/es.hpp"

#include "core/events/formats.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::string header(std::uint8_t kind, Bytes size = {0x40, 0x01, 0xF0, 0x00}, std::uint8_t version = 2) {
  return "Event Stream" + data_of(Bytes{version, 0, 0, kind}) + data_of(size);
}

std::unique_ptr<EventReader> es(const std::string& content, const ReadOptions& options = {}) {
  return open_es(bytes_of(content), options);
}

}  // namespace

TEST_CASE("A real Event Stream recording decodes to its known count and duration") {
  const auto path = data_file("formats/faery/dvs.es");
  if (!path) return;
  const auto reader = open_events(*path);
  const auto events = read_all(*reader);
  CHECK(events.size() == 473'225);
  CHECK(static_cast<double>(events.back().t - events.front().t) * 1e-6 == Approx(1.0).margin(1e-3));
  CHECK(reader->info().width == 320);
  CHECK(reader->info().height == 240);
  CHECK(reader->faults().empty());
}

TEST_CASE("DVS events have five bytes, and overflows of 127 us") {
  const auto reader = es(header(1) + data_of(Bytes{0x03, 1, 1, 2, 0, 0xFF, 0xFF, 0xFE, 0x04, 3, 0, 4, 0}));
  CHECK((read_all(*reader) == std::vector<Event>{{1, 257, 237, true}, {1 + 254 + 2, 3, 235, false}}));
}

TEST_CASE("Rows of Event Stream count from the bottom, and those that no sensor has stay outside") {
  const auto reader = es(header(1, {4, 0, 3, 0}) +
                         data_of(Bytes{0x02, 0, 0, 0, 0, 0x02, 1, 0, 2, 0, 0x02, 2, 0, 3, 0, 0x02, 3, 0, 0xFF, 0xFF}));
  const std::vector<Event> events = read_all(*reader);
  REQUIRE(events.size() == 4);
  CHECK(events[0].y == 2);
  CHECK(events[1].y == 0);
  CHECK(events[2].y >= 3);
  CHECK(events[3].y >= 3);
}

TEST_CASE("ATIS events have overflows of 63 us with a number, and exposure measurements between them") {
  const auto reader = es(header(2) + data_of(Bytes{0x06, 1, 0, 2, 0,     // 1 us, on
                                                   0xFF, 0xFD, 0xFC,     // 3 overflows, 1, a reset
                                                   0x09, 5, 0, 6, 0,     // 2 us, an exposure measurement
                                                   0x04, 3, 0, 4, 0}));  // 1 us, off
  CHECK((read_all(*reader) == std::vector<Event>{{1, 1, 237, true}, {1 + 4 * 63 + 3, 3, 235, false}}));
}

TEST_CASE("Event Stream files of another version or kind, or without pixels, are refused") {
  CHECK_THROWS_AS(es(""), InputError);
  CHECK_THROWS_AS(es("Event Stream"), InputError);
  CHECK_THROWS_AS(es("Event Steam and more bytes"), InputError);
  CHECK_THROWS_AS(es(header(1, {1, 0, 1, 0}, 1)), InputError);
  for (const int kind : {0, 3, 4, 200}) CHECK_THROWS_AS(es(header(static_cast<std::uint8_t>(kind))), InputError);
  CHECK_THROWS_AS(es(header(1, {0, 0, 1, 0})), InputError);
  CHECK(es(header(1, {1, 0, 1, 0}))->info().width == 1);
  CHECK(read_all(*es(header(1))).empty());
}

TEST_CASE("Event Stream files truncated anywhere, or with any bytes, are read as far as they go") {
  for (const std::uint8_t kind : Bytes{1, 2}) {
    std::string content = header(kind);
    for (int i = 0; i < 500; ++i) content += data_of(Bytes{0x04, 1, 0, 2, 0, 0xFF, 0x08, 3, 0, 4, 0});
    check_survives(content, [](const std::string& bytes) { return es(bytes); });
    const auto reader = es(content + "xy");
    CHECK(read_all(*reader).size() == 1000);
    CHECK(fault_counts(*reader) == std::vector<std::int64_t>{1});
    CHECK_THROWS_AS(read_all(*es(content + "xy", {.strict = true})), InputError);
  }
}
