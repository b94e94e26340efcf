#include "frontends/process/process_frontend.hpp"

#include <limits>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "core/testing/event_list.hpp"

using namespace evbench;
using namespace evbench::process;
using Catch::Matchers::ContainsSubstring;

namespace {

class FakeSource : public Source {
 public:
  explicit FakeSource(std::vector<Event> events) : events_(std::move(events)) {
    camera_.width = 240;
    camera_.height = 180;
    camera_.pinhole = {200, 200, 120, 90};
    camera_.distortion = DistortionModel::equidistant;
    camera_.coefficients << 0.1, 0.2, 0, 0, 0;
  }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, 1.0}; }
  const PoseTrajectory& ground_truth() const override { return trajectory_; }
  std::unique_ptr<EventReader> all_events() const override {
    if (events_.empty()) return nullptr;
    return std::make_unique<testing::EventList>(events_, camera_.width, camera_.height, 3);  // a few at a time
  }

 private:
  std::vector<Event> events_;
  Camera camera_;
  PoseTrajectory trajectory_;
};

/// 100 events in the second, every other pair of one time.
std::vector<Event> some_events() {
  std::vector<Event> events;
  for (int i = 0; i < 100; ++i) {
    events.push_back({i / 2 * 20000 + 1, static_cast<std::uint16_t>(i), 50, i % 2 == 0});
  }
  return events;
}

const char* const kBegin = R"(
import json, sys
def receive(): return json.loads(sys.stdin.readline())
def send(x): print(json.dumps(x), flush=True)
hello = receive()
)";

/// Each event is an observation of a track of its own, which ends with it; received lines go to the standard error.
const char* const kEach = R"(
send({"evbench": 1, "name": "each", "needs": ["expected"]})
print(json.dumps(hello), file=sys.stderr)
while "finish" not in (m := receive()):
  print(json.dumps({**m, "events": m["events"][:2]}), file=sys.stderr)
  send({"observations": [[x, t, x, y, 0.5] for t, x, y, p in m["events"]], "ended": [[x, t] for t, x, y, p in m["events"]]})
send({"remarks": ["that was all"]})
)";

class Session {
 public:
  explicit Session(const std::string& script, int chunk = 5000, std::vector<Event> events = some_events())
      : source_(std::move(events)) {
    folder_.write("frontend.py", kBegin + script);
    ProcessFrontEnd::Options options;
    options.command = {"/usr/bin/python3", "frontend.py"};
    options.chunk = chunk;
    options.timeout = 20.0;
    frontend = std::make_unique<ProcessFrontEnd>(options,
                                                 FrontEndContext{source_, 7, folder_.path(), "config.json: frontend"});
  }

  struct Result {
    std::vector<TrackObservation> observations;
    std::vector<TrackEnd> ended;
    std::vector<double> until;
  };
  Result go(double interval, std::size_t most = 0) const {
    Result result;
    TrackBatch batch;
    double now = 0.0;
    for (bool more = true; more && now < 1.0;) {
      more = frontend->advance({std::min(1.0, now + interval), most}, batch);
      now = batch.until;
      result.until.push_back(now);
      result.observations.insert(result.observations.end(), batch.observations.begin(), batch.observations.end());
      result.ended.insert(result.ended.end(), batch.ended.begin(), batch.ended.end());
    }
    return result;
  }
  std::string remarks() const {
    std::string all;
    for (const std::string& remark : frontend->remarks()) all += remark + "\n";
    return all;
  }

 private:
  testing::TemporaryFolder folder_;
  FakeSource source_;

 public:
  std::unique_ptr<ProcessFrontEnd> frontend;
};

/// Of a process that answers `answer`, Python, to each chunk.
std::string failure(const std::string& answer) {
  try {
    Session(
        "send({'evbench': 1})\ni = 0\nwhile 'finish' not in (m := receive()):\n  t = m['until']\n  i += 1\n  send(" +
        answer + ")\nsend({})")
        .go(0.25);
  } catch (const ProcessError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("A front-end process gets every event once, however they are cut, and answers with observations") {
  const int chunk = GENERATE(1, 7, 5000);
  const double interval = GENERATE(0.01, 0.3, 1.0);
  const Session session(kEach, chunk);
  const Session::Result result = session.go(interval);
  REQUIRE(result.observations.size() == 100);
  REQUIRE(result.ended.size() == 100);
  for (std::size_t i = 0; i < 100; ++i) {
    REQUIRE(result.observations[i].track == static_cast<TrackId>(i));
    REQUIRE(result.observations[i].t == static_cast<double>(some_events()[i].t) / 1e6);
    REQUIRE(result.observations[i].noise == 0.5);
    REQUIRE(result.ended[i].t == result.observations[i].t);
  }
  CHECK(result.until.back() == 1.0);
  CHECK_THAT(session.remarks(), ContainsSubstring("front-end process: each") && ContainsSubstring("that was all"));
}

TEST_CASE("A front-end process receives camera, range and seed") {
  const Session session(kEach);
  session.go(1.0);
  CHECK_THAT(session.remarks(),
             ContainsSubstring(
                 R"({"evbench": 1, "kind": "frontend", "seed": 7, "range": [0.0, 1.0], "camera": {"width": 240, )"
                 R"("height": 180, "fx": 200.0, "fy": 200.0, "cx": 120.0, "cy": 90.0, "distortion": {"model": )"
                 R"("equidistant", "coefficients": [0.1, 0.2, 0.0, 0.0]}}, "options": {}})"));
  CHECK_THAT(session.remarks(), ContainsSubstring(R"({"until": 1, "events": [[1e-06, 0, 50, 1], [1e-06, 1, 50, 0]])"));
}

TEST_CASE("An exchange every so many observations ends with the last of them") {
  const Session session(kEach, 9);
  const Session::Result result = session.go(10.0, 5);
  CHECK(result.observations.size() == 100);
  REQUIRE(result.until.size() > 10);
  // Two of each time: the sixth has that of the fifth.
  CHECK(result.until[0] == 0.040001);
  CHECK(result.until[1] == 0.100001);
}

TEST_CASE("A front-end process receives the feedback that it needs") {
  const Session session(kEach);
  CHECK(session.frontend->needs().any);
  CHECK(session.frontend->needs().expected);
  CHECK_FALSE(session.frontend->needs().covariance);
  TrackBatch batch;
  session.frontend->advance({0.5}, batch);
  Feedback feedback;
  feedback.t = 0.5;
  feedback.state = TrackingState::tracking;
  feedback.expected = {{4, {1, 2, 3}, {10.5, 20.25}, Matrix2::Identity()}};
  session.frontend->receive(feedback);
  session.frontend->receive(feedback);
  session.frontend->advance({1.0}, batch);
  const std::string sent = R"({"t": 0.5, "state": "tracking", "world": 0, "outliers": [], )"
                           R"("expected": [[4, 1, 2, 3, 10.5, 20.25, 1, 0, 1]]})";
  CHECK_THAT(session.remarks(),
             ContainsSubstring("\"feedback\": []") && ContainsSubstring("\"feedback\": [" + sent + ", " + sent + "]"));
}

TEST_CASE("A front-end process receives the time also where there are no events") {
  const Session session(kEach, 5000, {{500000, 1, 1, true}});
  CHECK(session.go(0.1).observations.size() == 1);
  CHECK_THAT(session.remarks(), ContainsSubstring(R"({"until": 0.1, "events": [], "feedback": []})"));
}

TEST_CASE("Every wrong answer of a front-end process is reported by a sentence") {
  CHECK(failure("{'observations': [[1, t, 5, 5, 1]]}").empty());
  CHECK_THAT(failure("{}"),
             ContainsSubstring("config.json: frontend: the process \"/usr/bin/python3 frontend.py\" answered "
                               "wrongly: \"observations\" is missing in {}; last message to it: the events until "
                               "0.25 s"));
  CHECK_THAT(failure("{'observations': [], 'end': []}"),
             ContainsSubstring("unknown key \"end\"; did you mean \"ended\"?"));
  CHECK_THAT(failure("{'observations': [[1, t + 0.1, 5, 5, 1]]}"),
             ContainsSubstring("observations[0]: track 1 at 0.35 s: expected a time from 0 s and up to 0.25 s"));
  CHECK_THAT(failure("{'observations': [[1, 0.25, 5, 5, 1]]}"),
             ContainsSubstring("expected a time after 0.25 s and up to 0.5 s"));
  CHECK_THAT(failure("{'observations': [[1, t, 5, 5, 1], [1, t, 6, 6, 1]]}"),
             ContainsSubstring("observations[1]: track 1 at 0.25 s: expected a time after the track's last, 0.25 s"));
  CHECK_THAT(failure("{'observations': [[1, t, 5, 5, 1]], 'ended': [[1, t]]}"),
             ContainsSubstring("has ended before; expected another number for a new track"));
  CHECK_THAT(failure("{'observations': [], 'ended': [[1, t]]}"), ContainsSubstring("was never observed"));
  CHECK_THAT(failure("{'observations': [[i, t, 5, 5, 1]], 'ended': [[1, t]]}"), ContainsSubstring("has ended before"));
  CHECK_THAT(failure("{'observations': [[1, t, 5, 5, 1]], 'ended': [[1, t - 0.1]]}"),
             ContainsSubstring("expected a time from its last observation on"));
  CHECK_THAT(failure("{'observations': [[1, t, float('inf'), 5, 1]]}"),
             ContainsSubstring("JSON has no NaN and no Infinity"));
  CHECK_THAT(failure("{'error': 'too dark'}"), ContainsSubstring("reports an error: too dark"));
  CHECK_THAT(failure("exit(5)"), ContainsSubstring("ended with exit code 5"));
  CHECK_THROWS_WITH(Session("send({'evbench': 1, 'needs': ['all']})"),
                    ContainsSubstring("needs[0]: expected \"feedback\""));
}

TEST_CASE("A front-end process needs a source with events") {
  CHECK_THROWS_WITH(Session(kEach, 5000, {}),
                    ContainsSubstring("config.json: frontend: process needs a source with events"));
}
