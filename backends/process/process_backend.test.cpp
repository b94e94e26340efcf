#include "backends/process/process_backend.hpp"

#include <cmath>

#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::process;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The beginning of each of the processes below.
const char* const kBegin = R"(
import json, sys
def hear(): return json.loads(sys.stdin.readline())
def say(x): print(json.dumps(x), flush=True)
def pose(t, x): return [t, x, 0, 0, 0, 0, 0, 1]
hello = hear()
)";

/// Moves along x by a metre a second; writes what it receives to its standard error.
const char* const kStraight = R"(
say({"evbench": 1, "name": "straight on"})
print(json.dumps(hello), file=sys.stderr)
last = 0.0
while "finish" not in (m := hear()):
  print(json.dumps(m), file=sys.stderr)
  last = m["until"]
  say({"state": "tracking", "causal_poses": [pose(last, last)], "newest": pose(last, last),
       "outliers": [len(m["observations"])]})
say({"trajectory": [pose(0, 0), pose(last, last)], "map": [[7, 1, 2, 3]]})
)";

class Session {
 public:
  explicit Session(const std::string& script, const std::string& more = "") {
    folder_.write("backend.py", kBegin + script);
    const auto options = read_options<ProcessOptions>(
        parse_json(R"({"command": ["/usr/bin/python3", "backend.py"], "options": {"a": [1, null]})" + more + "}"),
        "config");
    BackEndContext context;
    context.camera = {500, 510, 320, 240};
    context.seed = 18446744073709551615U;
    context.folder = folder_.path();
    context.place = "config.json: backend";
    context.publish = [this](const CausalPose& pose) { causal.push_back(pose); };
    context.log = [this](const std::string& line) { log += line + "\n"; };
    backend = std::make_unique<ProcessBackEnd>(options, context);
  }

  /// Sends three batches of 0.1 s, and the end.
  Session& go() {
    for (int i = 1; i <= 3; ++i) {
      const double t = 0.1 * i;
      backend->advance({{{i, t - 0.05, {1.5, 2.5}, 0.7}}, {{i, t - 0.01}}, t});
    }
    backend->finish();
    return *this;
  }

  std::vector<CausalPose> causal;
  std::string log;
  std::unique_ptr<ProcessBackEnd> backend;

 private:
  testing::TemporaryFolder folder_;
};

/// The error of a process that answers `answer`, Python, to its batches, and `final` to the end.
std::string failure(const std::string& answer, const std::string& final = R"({"trajectory": [pose(0, 0)]})") {
  try {
    Session("say({'evbench': 1})\nwhile 'finish' not in (m := hear()):\n  t = m['until']\n  say(" + answer + ")\nsay(" +
            final + ")\n")
        .go();
  } catch (const ProcessError& error) {
    return error.what();
  }
  return "";
}

/// The error of a process with this script.
std::string failure_of(const std::string& script, const std::string& more = "") {
  try {
    Session(script, more).go();
  } catch (const ProcessError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("A back-end process receives camera, observations and ended tracks, and answers with poses") {
  Session session(kStraight);
  session.go();
  CHECK_THAT(session.log, ContainsSubstring("back-end process: straight on"));
  CHECK_THAT(session.log, ContainsSubstring(
                              R"("kind": "backend", "seed": 18446744073709551615, "patience": 1.0, "camera": )"
                              R"({"fx": 500.0, "fy": 510.0, "cx": 320.0, "cy": 240.0}, "options": {"a": [1, null]}})"));
  CHECK_THAT(session.log,
             ContainsSubstring(R"({"until": 0.1, "observations": [[1, 0.05, 1.5, 2.5, 0.7]], "ended": [[1, 0.09)"));
  REQUIRE(session.causal.size() == 3);
  CHECK(session.causal[2].t == 0.1 * 3);  // to the last bit
  CHECK(session.causal[2].T.p == Vector3(0.1 * 3, 0, 0));
  CHECK(session.backend->trajectory().size() == 2);
  CHECK(session.backend->trajectory().pose(0.15)->p.x() == Approx(0.15));
  REQUIRE(session.backend->map().size() == 1);
  CHECK(session.backend->map()[0].track == 7);
  CHECK(session.backend->status().state == RunState::ok);
  CHECK(session.backend->updates().size() == 3);
}

TEST_CASE("A back-end process may publish a velocity, and an older time again, known at the batch's end") {
  Session session(R"(
say({"evbench": 1})
while "finish" not in (m := hear()):
  t = m["until"]
  say({"state": "tracking", "causal_poses": [pose(t - 0.05, 1) + [0, 0, 0.5, 2, 0, 0], pose(0, t)]})
say({"trajectory": [pose(0, 0)]})
)");
  session.go();
  REQUIRE(session.causal.size() == 6);
  CHECK(session.causal[4].known_at == 0.1 * 3);
  CHECK(session.causal[4].velocity.value()[3] == 2.0);
  CHECK(session.causal[5].t == 0.0);
  CHECK_FALSE(session.causal[5].velocity);
}

TEST_CASE("Feedback of a back-end process has outliers since the last one, and a velocity even if none was sent") {
  Session session(kStraight);
  session.backend->advance({{}, {}, 0.5});
  session.backend->advance({{{3, 0.6, {1, 1}, 1.0}}, {}, 1.0});
  const BackEndFeedback feedback = session.backend->feedback({true, true, true});
  CHECK(feedback.state == TrackingState::tracking);
  CHECK(feedback.outliers == std::vector<TrackId>{0, 1});
  REQUIRE(feedback.newest);
  CHECK((feedback.newest->velocity - (Vector6() << 0, 0, 0, 1, 0, 0).finished()).norm() < 1e-12);
  CHECK_FALSE(feedback.covariance);
  CHECK_FALSE(session.backend->covariance(1.0));
  CHECK(session.backend->feedback({true, false, false}).outliers.empty());
}

TEST_CASE("The covariance that a back-end process sends is that of its newest pose") {
  Session session(R"(
say({"evbench": 1})
while "finish" not in (m := hear()):
  t = m["until"]
  say({"state": "tracking", "newest": pose(t, 1), "covariance": [4.0 * (i % 13 == 0) for i in range(144)]})
say({"trajectory": [pose(0, 0)]})
)");
  session.backend->advance({{}, {}, 0.5});
  REQUIRE(session.backend->covariance(0.5));
  CHECK(*session.backend->covariance(0.5) == Matrix12(4.0 * Matrix12::Identity()));
  CHECK_FALSE(session.backend->covariance(0.4));
  CHECK(session.backend->feedback({true, true, true}).covariance);
}

TEST_CASE("The status of a run follows from the states that a process answers") {
  const auto script = [](const std::string& states, const std::string& final) {
    return "say({'evbench': 1})\nfor state in " + states +
           ":\n  hear()\n  say({'state': state, 'reason': 'fog'})\nhear()\nsay(" + final + ")\n";
  };
  const std::string one_pose = "{'trajectory': [pose(0, 0)]}";
  const auto status = [&](const std::string& states, const std::string& final) {
    return Session(script(states, final)).go().backend->status();
  };
  CHECK(status("['no_map', 'tracking', 'stationary']", one_pose).state == RunState::ok);
  CHECK(status("['no_map', 'tracking', 'standing_still']", one_pose).state == RunState::ok);  // before version 1.0
  const Status degraded = status("['tracking', 'degraded', 'tracking']", one_pose);
  CHECK(degraded.state == RunState::degraded);
  REQUIRE(degraded.degraded.size() == 1);
  CHECK(degraded.degraded[0].from == 0.1);
  CHECK(degraded.degraded[0].to == 0.2);
  CHECK(degraded.degraded[0].reason == "fog");
  const Status lost = status("['tracking', 'degraded', 'lost']", one_pose);
  CHECK(lost.state == RunState::lost);
  CHECK(lost.time == 0.1);
  CHECK(status("['tracking', 'tracking', 'lost']", one_pose).time == 0.2);
  // A wrong map, of which no pose was published:
  CHECK(status("['degraded', 'no_map', 'tracking']", one_pose).state == RunState::ok);
  const Status none = status("['no_map'] * 3", "{'trajectory': []}");
  CHECK(none.state == RunState::failed);
  CHECK_THAT(none.reason, ContainsSubstring("no trajectory"));
  const Status own = status("['tracking'] * 3",
                            "{'trajectory': [pose(0, 0)], 'status': {'state': 'lost', 'reason': 'dark', 'time': 0.25, "
                            "'degraded': [[0.1, 0.2, 'dusk']]}}");
  CHECK(own.state == RunState::lost);
  CHECK(own.time == 0.25);
  CHECK(own.degraded.at(0).reason == "dusk");
  CHECK_THROWS_WITH(
      status("['tracking', 'lost', 'lost']", "{'trajectory': [pose(0, 0)], 'status': {'state': 'ok'}}"),
      ContainsSubstring("expected \"lost\" or \"failed\" of a process that has reported that it is lost"));
}

TEST_CASE("A back-end process that is lost reports it before the end") {
  Session session(
      "say({'evbench': 1})\nhear()\nsay({'state': 'lost', 'reason': 'fog'})\nhear()\nsay({'trajectory': []})");
  session.backend->advance({{}, {}, 0.1});
  CHECK(session.backend->status().state == RunState::lost);
  CHECK(session.backend->status().reason == "fog");
}

TEST_CASE("Each wrong answer of a back-end process gives an error that explains it") {
  CHECK(failure("{'state': 'tracking', 'causal_poses': [pose(t, 0)]}").empty());
  CHECK(failure("{'state': 'tracking', 'online': [pose(t, 0)]}").empty());  // before version 1.0
  CHECK_THAT(failure("{'state': 'tracking', 'causal_poses': [pose(float('nan'), 0)]}"),
             ContainsSubstring(
                 "config.json: backend: the process \"/usr/bin/python3 backend.py\" answered wrongly: expected one "
                 "JSON object a line, found {\"state\": \"tracking\", \"causal_poses\": [[NaN") &&
                 ContainsSubstring("JSON has no NaN") &&
                 ContainsSubstring("last message to it: the batch until 0.1 s") &&
                 ContainsSubstring("it wrote nothing to its standard error"));
  CHECK_THAT(failure("{}"), ContainsSubstring("\"state\" is missing"));
  CHECK_THAT(failure("7"), ContainsSubstring("expected a JSON object, found 7"));
  CHECK_THAT(failure("{'state': 'fine'}"), ContainsSubstring("unknown state \"fine\""));
  CHECK_THAT(failure("{'state': 'tracking', 'outlier': []}"),
             ContainsSubstring("unknown key \"outlier\"; did you mean"));
  CHECK_THAT(failure("{'state': 'tracking', 'causal_poses': [pose(t + 0.1, 0)]}"),
             ContainsSubstring("later than what has been seen"));
  CHECK_THAT(failure("{'state': 'tracking', 'causal_poses': [[t, 0, 0, 0, 0, 0, 0, 2]]}"),
             ContainsSubstring("quaternion's norm is 2"));
  CHECK_THAT(failure("{'state': 'tracking', 'causal_poses': [[t, 0, 0, 0, 0, 0, 1]]}"),
             ContainsSubstring("expected 8 numbers"));
  CHECK_THAT(failure("{'state': 'tracking', 'covariance': [0] * 144}"),
             ContainsSubstring("expected \"newest\" with it"));
  CHECK_THAT(failure("{'state': 'tracking' if t < 0.15 else 'no_map', 'causal_poses': [pose(0.1, 0)]}"),
             ContainsSubstring("expected \"lost\", because poses were published"));
  CHECK_THAT(failure("{'state': 'lost' if t < 0.15 else 'no_map', 'reason': 'fog'}"),
             ContainsSubstring("expected \"lost\""));
  CHECK_THAT(failure("{'error': 'I can not see'}"),
             ContainsSubstring("reports an error: I can not see; last message to it: the batch"));
  const std::string good = "{'state': 'tracking'}";
  CHECK_THAT(failure(good, "{}"), ContainsSubstring("\"trajectory\" is missing") &&
                                      ContainsSubstring("last message to it: the finish message"));
  CHECK_THAT(failure(good, "{'trajectory': [pose(1, 0), pose(1, 0)]}"), ContainsSubstring("strictly increasing"));
  CHECK_THAT(failure(good, "{'trajectory': [], 'map': [[1, 2]]}"),
             ContainsSubstring("map[0]: expected 4 numbers (track x y z)"));
  CHECK_THAT(failure(good, "{'trajectory': [pose(0, 0)], 'status': {'state': 'lost'}}"),
             ContainsSubstring("\"reason\" is missing"));
}

TEST_CASE("A back-end process of another version, or of none, is refused") {
  CHECK_THAT(failure_of("say({'evbench': 2})"), ContainsSubstring("it speaks version 2 of the protocol; expected 1"));
  CHECK_THAT(failure_of("say({'name': 'x'})"), ContainsSubstring("\"evbench\" is missing") &&
                                                   ContainsSubstring("last message to it: the opening message"));
  CHECK_THAT(failure_of("print('Welcome!', flush=True)"), ContainsSubstring("found Welcome!"));
}

TEST_CASE("A back-end process that crashes, ends or keeps silent fails with the last lines of its standard error",
          "[slow]") {
  CHECK_THAT(failure_of("say({'evbench': 1})\nhear()\nraise ValueError('an odd track')"),
             ContainsSubstring(
                 "ended with exit code 1; last message to it: the batch until 0.1 s; the last lines of its standard "
                 "error:\n  Traceback") &&
                 ContainsSubstring("\n  ValueError: an odd track"));
  CHECK_THAT(failure_of("say({'evbench': 1})\nhear()\nimport os; os.kill(os.getpid(), 11)"),
             ContainsSubstring("was ended by signal 11 (Segmentation fault)"));
  CHECK_THAT(
      failure_of("say({'evbench': 1})\nhear()\nprint('hm', file=sys.stderr, flush=True)\nimport time; time.sleep(60)",
                 R"(, "timeout": 0.3)"),
      ContainsSubstring("did not answer within 0.3 s (is each of its lines flushed?)") && ContainsSubstring("\n  hm"));
  CHECK_THAT(
      failure_of("say({'evbench': 1})\nfor i in range(100000): print('line', i, file=sys.stderr)\nhear()\nsay(1)"),
      ContainsSubstring("(99980 lines before these)\n  line 99980\n") && ContainsSubstring("line 99999"));
  CHECK_THAT(
      failure_of("say({'evbench': 1})\nsay({'state': 'tracking'})\nimport time; time.sleep(0.1)\nhear(); hear()"),
      ContainsSubstring("before it was asked") || ContainsSubstring("ended"));
}

TEST_CASE("A back-end process that has failed stays failed") {
  Session session("say({'evbench': 1})");
  std::string first, second;
  for (std::string* const what : {&first, &second}) {
    try {
      session.backend->advance({{}, {}, 0.1});
    } catch (const ProcessError& error) {
      *what = error.what();
    }
  }
  CHECK_THAT(first, ContainsSubstring("ended with exit code 0"));
  CHECK(first == second);
}

TEST_CASE("A command that makes no sense is reported with its place") {
  BackEndContext context;
  context.place = "config.json: backend";
  const auto make = [&](const std::string& options) {
    return std::make_unique<ProcessBackEnd>(read_options<ProcessOptions>(parse_json(options), context.place), context);
  };
  CHECK_THROWS_WITH(make("{}"), ContainsSubstring("\"command\" is missing"));
  CHECK_THROWS_WITH(make(R"({"command": []})"),
                    ContainsSubstring("config.json: backend.command: expected a list of texts"));
  CHECK_THROWS_WITH(make(R"({"command": 7})"), ContainsSubstring("found 7"));
  CHECK_THROWS_WITH(make(R"({"command": ["a", 7]})"), ContainsSubstring("found [\"a\",7]"));
  CHECK_THROWS_WITH(
      make(R"({"command": ["no_such_program_here"]})"),
      ContainsSubstring("the process \"no_such_program_here\" can't be started: there is no such command"));
  CHECK_THROWS_WITH(make(R"({"command": "no_such_program_here"})"), ContainsSubstring("not found"));
  CHECK_THROWS_WITH(make(R"({"command": ["cat"], "folder": "/no/folder"})"),
                    ContainsSubstring("in the folder /no/folder"));
}

TEST_CASE("The files that a command names are part of a run's identity, but not their location") {
  const testing::TemporaryFolder folder;
  folder.write("backend.py", "");
  folder.write("weights", "");
  Plugins plugins = registered_plugins();
  const auto& entry = plugins.of<BackEnd>().find("process", "test");
  const auto resolved = [&](const std::string& options) {
    return entry.resolve(parse_json(options), "config.json: backend", folder.path());
  };
  const Json list = resolved(R"({"command": ["python3", "backend.py", "none.py"], "files": ["weights"]})");
  CHECK(entry.files(list) == std::vector<std::string>{folder.file("backend.py"), folder.file("weights")});
  CHECK_FALSE(entry.identity(list).contains("folder"));
  const Json text = resolved(R"({"command": "nice python3 'backend.py' | cat"})");
  CHECK(entry.files(text) == std::vector<std::string>{folder.file("backend.py")});
  CHECK_THROWS_WITH(entry.files(resolved(R"({"command": ["cat"], "files": ["none"]})")),
                    ContainsSubstring("/none: no such file; the option \"files\" names it"));
}

TEST_CASE("The time that an exchange takes in addition to the process' own") {
  Session session(R"(
say({"evbench": 1})
for line in sys.stdin:
  if line.startswith('{"finish'): break
  print('{"state":"tracking"}', flush=True)
say({"trajectory": [pose(0, 0)]})
)");
  UndistortedBatch batch;
  double seconds = 0.0;
  constexpr int kExchanges = 500;
  for (int i = 1; i <= kExchanges; ++i) {
    batch.until = 0.01 * i;
    batch.observations.assign(50, {i, 0.01 * i, {320.12345678, 240.12345678}, 0.7});
    session.backend->advance(batch);
    seconds += session.backend->updates().back().seconds;
  }
  session.backend->finish();
  WARN("an exchange of 50 observations: " << 1e6 * seconds / kExchanges << " us");
  CHECK(seconds / kExchanges < 0.01);
}
