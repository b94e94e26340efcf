#include "bench/battery/battery.hpp"

#include "core/plugin/registration.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/event_scene.hpp"

using namespace evbench;
using namespace evbench::battery;

namespace {

/// The sentence of each check that fails.
std::vector<std::string> failures(const std::vector<Check>& checks) {
  std::vector<std::string> result;
  for (const Check& check : checks) {
    try {
      check.run();
    } catch (const std::exception& error) {
      result.push_back(check.name + ": " + error.what());
    }
  }
  return result;
}

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += sentence + "\n";
  return text;
}

/// A back-end as a careless author might write it: ok without a map, feedback from the future, another result each
/// time.
class Careless : public BackEnd {
 public:
  struct Options {
    void declare(OptionSet&) {}
  };
  Careless(const Options&, const BackEndContext& context) : context_(context) {}

  void advance(const UndistortedBatch& batch) override {
    const double x = static_cast<double>(++advances_);
    poses_.push_back({batch.until, {Eigen::Quaterniond::Identity(), {x, 0, 0}}});
    context_.publish({poses_.back()});
  }
  BackEndFeedback feedback(const FeedbackNeeds&) override {
    BackEndFeedback feedback;
    feedback.newest = ControlState{poses_.back().t + 1.0, poses_.back().T, Vector6::Zero()};
    return feedback;
  }
  void finish() override {}
  Status status() const override { return {}; }
  PoseTrajectory trajectory() const override {
    std::vector<StampedPose> poses = poses_;
    return PoseTrajectory(std::move(poses));
  }
  std::vector<Landmark> map() const override { return {}; }

 private:
  static inline int advances_ = 0;
  BackEndContext context_;
  std::vector<StampedPose> poses_;
};

}  // namespace

TEST_CASE("Every built-in back-end passes the battery, check by check", "[long]") {
  const Plugins plugins = registered_plugins();
  for (const char* name : {"gp_map", "bundle_adjustment"}) {
    for (const Check& check : backend_checks(plugins, name)) {
      INFO(name << " " << check.name);
      CHECK_NOTHROW(check.run());
    }
  }
}

TEST_CASE("gp_map passes the battery with a lag, and per observation", "[long]") {
  const Plugins plugins = registered_plugins();
  for (const char* options :
       {R"({"lag": 2})", R"({"per_observation": true})", R"({"placement": {"rule": "motion"}})"}) {
    INFO(options);
    CHECK(joined(failures(backend_checks(plugins, "gp_map", parse_json(options)))) == "");
  }
}

TEST_CASE("The battery reports what is wrong with a careless back-end") {
  Plugins plugins;
  Registry<BackEnd>::Entry entry;
  entry.with_options = [](const auto& use) {
    OptionSet none;
    use({none, [] { return std::vector<std::string>(); },
         [](const std::string&) { return std::vector<std::string>(); }});
  };
  entry.make = [](const Json&, const BackEndContext& context) {
    return std::make_unique<Careless>(Careless::Options{}, context);
  };
  plugins.of<BackEnd>().add("careless", entry);
  const std::vector<std::string> found = failures(backend_checks(plugins, "careless"));
  INFO(joined(found));
  CHECK(found.size() >= 8);
  CHECK_THAT(joined(found),
             Catch::Matchers::ContainsSubstring("without observations it is ok") &&
                 Catch::Matchers::ContainsSubstring("its map has 0 landmarks, where 50 tracks are seen") &&
                 Catch::Matchers::ContainsSubstring("is ok, though nothing was seen from 1.8 to 2.1 s") &&
                 Catch::Matchers::ContainsSubstring("final trajectories differ"));
}

TEST_CASE("The oracle and simulated sources pass the battery") {
  const Plugins plugins = registered_plugins();
  CHECK(joined(failures(frontend_checks(plugins, "oracle", Json::object(), usual_source()))) == "");
  CHECK(joined(failures(source_checks(plugins, "simulation", parse_json(R"({"duration": 2})")))) == "");
  const Json events = parse_json(
      R"({"duration": 0.2, "camera": {"width": 96, "height": 72, "focal_length": 80}, "tracks": {"alive": 10}})");
  CHECK(joined(failures(source_checks(plugins, "event_simulation", events))) == "");
}

TEST_CASE("haste passes the battery on events with each of its modes", "[slow]") {
  using testing::EventScene;
  const EventScene scene(testing::swing, 0.6, EventScene::quadrangles(150, 1));
  const Plugins plugins = registered_plugins();
  for (const char* options :
       {"{}", R"({"guidance": {"outliers": false, "veto": false, "reacquire": false}})",
        R"({"place": "new_state", "delay": 0})", R"({"detection": {"method": "histogram"}, "tracks": 10})"}) {
    INFO(options);
    CHECK(joined(failures(frontend_checks(plugins, "haste", parse_json(options), scene))) == "");
  }
}

TEST_CASE("An unknown plugin is an error before any check") {
  const Plugins plugins = registered_plugins();
  CHECK_THROWS_WITH(backend_checks(plugins, "gp_mop"), Catch::Matchers::ContainsSubstring("gp_map"));
}
