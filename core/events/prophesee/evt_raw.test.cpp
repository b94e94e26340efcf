#include "core/events/prophesee/evt_raw.hpp"

#include "core/events/bytes/bytes.hpp"
#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

/// Of expelliarmus' .npy: records of t (int64), x, y (int16), p (uint8), three bytes of nothing.
std::vector<Event> read_npy(const std::string& path) {
  const std::string file = read_file(path);
  const auto* bytes = reinterpret_cast<const std::byte*>(file.data());
  std::vector<Event> events;
  for (std::size_t at = 10 + load<std::uint16_t>(bytes + 8); at + 16 <= file.size(); at += 16) {
    events.push_back({load<std::int64_t>(bytes + at), load<std::uint16_t>(bytes + at + 8),
                      load<std::uint16_t>(bytes + at + 10), bytes[at + 12] != std::byte{0}});
  }
  return events;
}

std::unique_ptr<EventReader> evt3(const std::string& content, const ReadOptions& options = {}) {
  return open_evt3(bytes_of(content), options);
}
std::unique_ptr<EventReader> evt2(const std::string& content, const ReadOptions& options = {}) {
  return open_evt2(bytes_of(content), options);
}

const std::string kHeader3 = "% evt 3.0\n% geometry 1280x720\n";
const std::string kHeader2 = "% evt 2.0\n% geometry 640x480\n";
using Words16 = std::vector<std::uint16_t>;
using Words32 = std::vector<std::uint32_t>;
using Words64 = std::vector<std::uint64_t>;

}  // namespace

// The other program (expelliarmus) takes each step back of the low bits of time for a wrap, in addition to the wraps in
// the camera's own high bits: 4096 us too many each time. Time steps back 11 times in this file, 9 times by a few
// microseconds and twice at a change of the high bits, so that 8.8 ms appear as 53.9 ms.
TEST_CASE("A real EVT 3 recording decodes event by event to what another program makes of it, but for its wraps") {
  const auto raw = data_file("formats/expelliarmus/evt3_sample.raw");
  const auto npy = data_file("formats/expelliarmus/evt3_sample.npy");
  if (!raw || !npy) return;
  const auto reader = open_events(*raw);
  const auto events = read_all(*reader), theirs = read_npy(*npy);
  REQUIRE(events.size() == 219'596);
  REQUIRE(theirs.size() == events.size());
  std::int64_t wraps = 0, different = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (theirs[i].t - events[i].t == 4096 * (wraps + 1)) ++wraps;
    Event expected = theirs[i];
    expected.t -= 4096 * wraps;
    if (events[i] != expected) ++different;
  }
  CHECK(different == 0);
  CHECK(wraps == 11);
  CHECK(events.back().t - events.front().t == 8801);
  CHECK(reader->faults().empty());
  CHECK(reader->info().format == "Prophesee EVT 3");
  CHECK(reader->info().width == 1280);
  CHECK(reader->info().height == 720);
}

TEST_CASE("Real EVT 2 recordings decode to their known counts and durations") {
  const struct {
    const char* file;
    std::size_t count;
    double duration;
  } cases[] = {{"formats/faery/evt2.raw", 521'252, 0.0959}, {"formats/expelliarmus/evt2_sample.raw", 539'481, 0.050}};
  for (const auto& [name, count, duration] : cases) {
    const auto path = data_file(name);
    if (!path) continue;
    const auto reader = open_events(*path);
    const auto events = read_all(*reader);
    CHECK(events.size() == count);
    CHECK(static_cast<double>(events.back().t - events.front().t) * 1e-6 == Approx(duration).margin(1e-4));
    CHECK(reader->info().width == 640);
    CHECK(reader->info().height == 480);
    CHECK(reader->faults().empty());
  }
}

TEST_CASE("EVT 3 vectors give an event for each bit, from their base column on") {
  const auto reader = evt3(kHeader3 + data_of(Words16{0x8001, 0x6002, 0x0010, 0x3864, 0x4801, 0x5081, 0x2007}));
  const std::int64_t t = 0x1002;
  CHECK(read_all(*reader) ==
        std::vector<Event>{
            {t, 100, 16, true}, {t, 111, 16, true}, {t, 112, 16, true}, {t, 119, 16, true}, {t, 7, 16, false}});
}

TEST_CASE("EVT 3 times count on when their 24 bits are used up") {
  const auto reader = evt3(kHeader3 + data_of(Words16{0x8FFF, 0x6FFF, 0x0001, 0x2001, 0x8000, 0x2002, 0x6003, 0x2003}));
  const auto events = read_all(*reader);
  REQUIRE(events.size() == 3);
  CHECK(events[0].t == (1 << 24) - 1);
  CHECK(events[1].t == 1 << 24);
  CHECK(events[2].t == (1 << 24) + 3);
}

TEST_CASE("EVT 2 times count on when their 34 bits are used up") {
  const auto reader = evt2(kHeader2 + data_of(Words32{0x8FFFFFFF, 0x1FC00801, 0x80000000, 0x00401002}));
  CHECK(read_all(*reader) ==
        std::vector<Event>{{(std::int64_t{1} << 34) - 1, 1, 1, true}, {(std::int64_t{1} << 34) + 1, 2, 2, false}});
}

TEST_CASE("EVT 3 events of a time that was left over in a buffer are an oddity, and the others have their own times") {
  const auto path = data_file("cases/evt3_stale/evt3_stale.raw");
  if (!path) return;
  EventStream stream(*path);
  const auto events = read_all(stream);
  CHECK(events.size() == 3000);
  CHECK(events.front().t < 100);
  CHECK(events.back().t == 299'900);
  CHECK(stream.faults().size() == 2);
  EventStream strict(*path, {.read = {.strict = true}});
  CHECK_THROWS_WITH(read_all(strict), Catch::Matchers::ContainsSubstring("restarted"));
}

TEST_CASE("One wrong word of EVT 3's time, or another camera's start, does not move what follows") {
  Words16 words{0x0001};  // 20 s of an event each 4096 us
  for (int i = 0; i < 5000; ++i) words.insert(words.end(), {std::uint16_t(0x8000 | (i & 0xFFF)), 0x2001});
  for (const std::size_t at : {1001u, 3001u, 8001u}) {
    for (const std::uint16_t wrong : Words16{0x8001, 0x8800, 0x8FFE}) {
      Words16 broken = words;
      broken[at] = wrong;
      EventStream stream(evt3(kHeader3 + data_of(broken)), "test");
      const auto events = read_all(stream);
      CAPTURE(at, wrong);
      CHECK(events.size() == 4999);
      CHECK(events.back().t == 4999 * 4096);
      CHECK(stream.faults().size() == 2);
    }
  }
  Words16 restarted = words;
  restarted.insert(restarted.end(), words.begin() + 1, words.begin() + 1001);
  EventStream stream(evt3(kHeader3 + data_of(restarted)), "test");
  CHECK(read_all(stream).size() == 5000);
  CHECK(stream.faults().front().first.find("restarted") != std::string::npos);
  restarted.insert(restarted.end(), words.begin() + 1, words.begin() + 1001);
  EventStream broken(evt3(kHeader3 + data_of(restarted)), "test");
  CHECK_THROWS_WITH(read_all(broken), Catch::Matchers::ContainsSubstring("restarted"));
}

TEST_CASE("EVT 2.1 words give an event for each bit, whichever half comes first") {
  const std::vector<Event> expected{{0x45, 32, 3, true}, {0x45, 63, 3, true}, {0x46, 64, 4, false}};
  const std::uint64_t time = std::uint64_t{0x80000001} << 32;
  const std::uint64_t on = (std::uint64_t{0x10000000 | 5 << 22 | 32 << 11 | 3} << 32) | 0x80000001;
  const std::uint64_t off = (std::uint64_t{6 << 22 | 64 << 11 | 4} << 32) | 1;
  const auto modern =
      open_evt21(bytes_of("% format EVT21;height=720;width=1280\n% end\n" + data_of(Words64{time, on, off})), {});
  CHECK(read_all(*modern) == expected);
  CHECK(modern->info().width == 1280);
  const auto swapped = [](std::uint64_t word) { return word << 32 | word >> 32; };
  const auto legacy = open_evt21(bytes_of("% format EVT21;endianness=legacy;height=720;width=1280\n% end\n" +
                                          data_of(Words64{swapped(time), swapped(on), swapped(off)})),
                                 {});
  CHECK(read_all(*legacy) == expected);
}

TEST_CASE("A RAW header gives the sensor's size, or the options do, or the camera's name") {
  CHECK(evt3("% evt 3.0\n% geometry 320x320\n")->info().width == 320);
  CHECK(evt3("% format EVT3;height=720;width=1280\n% end\n")->info().height == 720);
  CHECK(evt3("% evt 3.0\n% plugin_name hal_plugin_gen41_evk3\n")->info().height == 720);
  CHECK(evt3("% evt 3.0\n% plugin_name hal_plugin_gen41_evk3\n", {.width = 640, .height = 480})->info().height == 480);
  CHECK(evt3("% evt 3.0\n")->info().width == 0);
  for (const std::string geometry : {"0x10", "99999999x5", "-5x4", "10", "axb", "640x480x3"}) {
    CHECK_THROWS_AS(evt3("% evt 3.0\n% geometry " + geometry + "\n"), InputError);
  }
}

TEST_CASE("RAW files of another encoding, without a header, or with an endless one are refused") {
  CHECK_THROWS_AS(evt3(kHeader2), InputError);
  CHECK_THROWS_AS(evt3("% evt 4.0\n"), InputError);
  CHECK_THROWS_AS(evt3("RIFF"), InputError);
  CHECK_THROWS_AS(evt3(""), InputError);
  CHECK_THROWS_AS(evt3("% evt 3.0\n% " + std::string(100'000, 'x')), InputError);
}

TEST_CASE("RAW files of other encodings are refused by the word of their header, and others have no columns") {
  const TemporaryFolder folder;
  const std::string data = data_of(Words32{0, 1, 2});
  for (const std::string line : {"% evt 4.0", "% format EVT4;height=720;width=1280", "% format HISTO3D;height=72"}) {
    const auto path = folder.write("a.raw", line + "\n% end\n" + data);
    CHECK_THROWS_WITH(open_events(path), Catch::Matchers::ContainsSubstring("in its header; expected EVT 2, 2.1 or 3"));
  }
  CHECK_THROWS_WITH(open_events(folder.file("a.raw")), Catch::Matchers::ContainsSubstring("encoding \"HISTO3D\""));
  const auto text = folder.write("a.txt", "% format txyp\n0.1 1 2 1\n0.2 1 2 0\n");
  CHECK(read_all(*open_events(text)).size() == 2);
  const auto evt3_file = folder.write("b.raw", kHeader3 + data_of(Words16{0x8001, 0x0010, 0x2001}));
  CHECK(read_all(*open_events(evt3_file)).size() == 1);
  CHECK_THROWS_WITH(open_events(evt3_file, {.columns = "t,x,y,p"}),
                    Catch::Matchers::ContainsSubstring("has no columns"));
  CHECK_THROWS_WITH(open_events(folder.write("dv.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n")),
                    Catch::Matchers::ContainsSubstring("is XML, e.g. a calibration or settings of DV"));
}

TEST_CASE("What makes no sense in a RAW file is counted and skipped, or refused") {
  const std::string early = kHeader3 + data_of(Words16{0x2001, 0x8001, 0x2002, 0x0003, 0x2004, 0x9000, 0x1000}) + "x";
  const auto reader = evt3(early);
  CHECK(read_all(*reader).size() == 1);
  CHECK(fault_counts(*reader) == std::vector<std::int64_t>{1, 2, 2});
  CHECK_THROWS_AS(read_all(*evt3(early, {.strict = true})), InputError);

  const auto evt2_reader = evt2(kHeader2 + data_of(Words32{0x10000000, 0x80000000, 0x10000000, 0x70000000}) + "xyz");
  CHECK(read_all(*evt2_reader).size() == 1);
  CHECK(fault_counts(*evt2_reader) == std::vector<std::int64_t>{1, 1, 1});
}

TEST_CASE("RAW files truncated anywhere, or with any bytes, are read as far as they go") {
  std::string content = kHeader3;
  for (int i = 0; i < 500; ++i) content += data_of(Words16{0x8001, 0x6002, 0x0010, 0x3864, 0x4FFF, 0x5081, 0x2007});
  check_survives(content, [](const std::string& bytes) { return evt3(bytes); });
  content.replace(0, kHeader3.size(), kHeader2);
  check_survives(content, [](const std::string& bytes) { return evt2(bytes); });
  content.replace(0, kHeader2.size(), "% evt 2.1\n");
  check_survives(content, [](const std::string& bytes) { return open_evt21(bytes_of(bytes), {}); });
}

TEST_CASE("After seeking, reading begins at or before that time") {
  const auto reader = evt3(kHeader3 + data_of(Words16{0x8001, 0x6002, 0x0010, 0x2001, 0x6003, 0x2002}));
  const auto all = read_all(*reader);
  reader->seek(0x1003);
  const auto again = read_all(*reader);
  REQUIRE(!again.empty());
  CHECK(again.front().t <= 0x1003);
  CHECK(again.back() == all.back());
}
