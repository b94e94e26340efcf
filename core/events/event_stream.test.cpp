#include "core/events/event_stream.hpp"

#include <algorithm>
#include <limits>

#include "core/events/sensor_size.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

namespace {

const StreamOptions kLenient{.read = {.lenient = true}};  // one of five events is more than a tenth

/// Gives events three at a time.
class ListReader : public EventReader {
 public:
  explicit ListReader(std::vector<Event> events) : events_(std::move(events)), faults_("list", false) {
    info_.width = info_.height = 10;
  }
  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override {
    const std::size_t last = std::min(next_ + 3, events_.size());
    events.assign(events_.begin() + static_cast<std::ptrdiff_t>(next_),
                  events_.begin() + static_cast<std::ptrdiff_t>(last));
    next_ = last;
    return !events.empty();
  }
  void seek(std::int64_t) override { next_ = 0; }
  const Faults& faults() const override { return faults_; }

 private:
  std::vector<Event> events_;
  StreamInfo info_;
  Faults faults_;
  std::size_t next_ = 0;
};

std::vector<std::int64_t> times(const std::vector<Event>& events, const StreamOptions& options) {
  EventStream stream(std::make_unique<ListReader>(events), "list", options);
  std::vector<std::int64_t> result;
  for (std::vector<Event> chunk; stream.read(chunk);) {
    for (const Event& event : chunk) result.push_back(event.t);
  }
  return result;
}

const std::vector<Event> kFive{
    {100, 1, 1, true}, {110, 2, 1, false}, {110, 3, 1, true}, {130, 4, 1, true}, {150, 5, 1, true}};

}  // namespace

TEST_CASE("A stream gives all events, or those in a range, from the file's zero or the first event's") {
  CHECK(times(kFive, {}) == std::vector<std::int64_t>{100, 110, 110, 130, 150});
  CHECK(times(kFive, {.rebase = true}) == std::vector<std::int64_t>{0, 10, 10, 30, 50});
  CHECK(times(kFive, {.from = 110, .to = 150}) == std::vector<std::int64_t>{110, 110, 130});
  CHECK(times(kFive, {.rebase = true, .from = 30}) == std::vector<std::int64_t>{30, 50});
  CHECK(times({}, {.rebase = true}).empty());
}

TEST_CASE("A time that is far too late is left out, not all that follow") {
  auto events = kFive;
  events[1].t = 1'000'000;
  CHECK(times(events, kLenient) == std::vector<std::int64_t>{100, 110, 130, 150});
  CHECK(times(events, {.read = {.lenient = true}, .to = 140}) == std::vector<std::int64_t>{100, 110, 130});
}

TEST_CASE("Times that would overflow are left out and counted") {
  auto events = kFive;
  events[0].t = std::numeric_limits<std::int64_t>::min();
  events[4].t = std::numeric_limits<std::int64_t>::max();
  EventStream stream(std::make_unique<ListReader>(events), "list", {.read = {.lenient = true}, .rebase = true});
  std::vector<Event> all;
  for (std::vector<Event> chunk; stream.read(chunk);) all.insert(all.end(), chunk.begin(), chunk.end());
  CHECK(all.size() == 3);
  REQUIRE(stream.faults().size() == 1);
  CHECK(stream.faults()[0].first == "events beyond any time (2^61 us)");
  CHECK(stream.faults()[0].second.count == 2);
}

TEST_CASE("A time that is far too late at the end of what a reader gives at once costs no more") {
  auto events = kFive;
  events[2].t = 1'000'000;  // the last of the first three
  CHECK(times(events, kLenient) == std::vector<std::int64_t>{100, 110, 130, 150});
  CHECK(times(events, {.read = {.lenient = true}, .to = 140}) == std::vector<std::int64_t>{100, 110, 130});
  events = kFive;
  events[3].t = 1'000'000;  // the first of the next
  CHECK(times(events, kLenient) == std::vector<std::int64_t>{100, 110, 110, 150});
}

TEST_CASE("Zero is the first event that is given, and faults before it are reported once") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("a.txt", "240 180\n10 240 1 1\nno event\n20 1 1 1\n30 2 2 0\n");
  for (const bool rebase : {false, true}) {
    CAPTURE(rebase);
    EventStream stream(path, {.read = {.lenient = true}, .rebase = rebase});
    std::vector<Event> all;
    for (std::vector<Event> chunk; stream.read(chunk);) all.insert(all.end(), chunk.begin(), chunk.end());
    REQUIRE(all.size() == 2);
    CHECK(all.front().t == (rebase ? 0 : 20));
    CHECK(stream.zero() == (rebase ? 20 : 0));
    const auto faults = stream.faults();
    REQUIRE(faults.size() == 2);
    CHECK(faults[0].second.count == 1);
    CHECK(faults[1].second.count == 1);
  }
}

TEST_CASE("Events outside the sensor or out of order are left out and counted, or refused") {
  auto events = kFive;
  events[1].x = 10;
  events[4].t = 120;
  EventStream stream(std::make_unique<ListReader>(events), "list", kLenient);
  std::size_t count = 0;
  for (std::vector<Event> chunk; stream.read(chunk);) count += chunk.size();
  CHECK(count == 3);
  REQUIRE(stream.faults().size() == 2);
  CHECK(stream.faults()[0].second.count == 1);
  StreamOptions strict;
  strict.read.strict = true;
  CHECK_THROWS_AS(times(events, strict), InputError);
}

TEST_CASE("A stream of which more than a tenth is left out ends with an error that says what, unless it is lenient") {
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) events.push_back({100 + i, 1, 1, true});
  events[3].x = events[7].y = 10;
  CHECK(times(events, {}).size() == 18);  // a tenth
  events[9].x = 10;
  CHECK_THROWS_WITH(times(events, {}),
                    "list: 15.0 % of the events, 3 of 20, have to be left out, most of them as events "
                    "outside the sensor of 10x10 pixels (the first: 103 us, pixel (10, 1)); expected "
                    "a recording with fewer faults, or --lenient (source.lenient in a run's config)");
  CHECK(times(events, kLenient).size() == 17);
  CHECK_THROWS_AS(times(events, {.to = 112}), InputError);
}

TEST_CASE("A sensor beyond any that is made is refused, an unknown one is not") {
  CHECK_NOTHROW(check_sensor_size("a", 0, 65536));
  CHECK_NOTHROW(check_sensor_size("a", 8000, 8000));
  CHECK_THROWS_WITH(check_sensor_size("a", 65535, 65535),
                    "a: a sensor of 65535x65535 pixels; expected 64 million pixels at most");
}

TEST_CASE("Reading can be interrupted, also where no event lies in the range") {
  StreamOptions options;
  options.from = GENERATE(0, 1000);
  EventStream stream(std::make_unique<ListReader>(kFive), "list", options);
  const Interruption interruption("interrupted");
  std::raise(SIGTERM);
  std::vector<Event> chunk;
  CHECK_THROWS_WITH(stream.read(chunk), "interrupted");
}

TEST_CASE("A stream can go back to any time") {
  EventStream stream(std::make_unique<ListReader>(kFive), "list", {.rebase = true});
  std::vector<Event> chunk;
  while (stream.read(chunk)) {
  }
  stream.seek(30);
  REQUIRE(stream.read(chunk));
  CHECK(chunk.front().t == 30);
}
