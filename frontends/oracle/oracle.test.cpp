#include "frontends/oracle/oracle.hpp"

#include <catch2/catch.hpp>

using namespace evbench;

namespace {

class FakeSource : public Source {
 public:
  std::optional<std::vector<TrackObservation>> tracks;

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, 1.0}; }
  const PoseTrajectory& ground_truth() const override { return trajectory_; }
  std::optional<std::span<const TrackObservation>> true_tracks() const override {
    if (!tracks) return std::nullopt;
    return *tracks;
  }

 private:
  Camera camera_;
  PoseTrajectory trajectory_;
};

}  // namespace

TEST_CASE("The oracle hands on the source's tracks up to the time asked for, each once") {
  FakeSource source;
  source.tracks = {{0, 0.1, {1, 1}, 1.0}, {1, 0.2, {2, 2}, 1.0}, {0, 0.3, {3, 3}, 1.0}};
  const auto oracle =
      Registry<FrontEnd>::instance().find("oracle", "test").make(Json::object(), "test", {source, 0, ""});
  std::vector<TrackObservation> observations;
  CHECK(oracle->advance(0.2, observations));
  CHECK(observations.size() == 2);
  CHECK(oracle->advance(0.25, observations));
  CHECK(observations.size() == 2);
  CHECK_FALSE(oracle->advance(1.0, observations));
  REQUIRE(observations.size() == 3);
  CHECK(observations[2].t == 0.3);
}

TEST_CASE("The oracle of a source without tracks has nothing to give") {
  FakeSource source;
  source.tracks.emplace();
  Oracle oracle({}, {source, 0, ""});
  std::vector<TrackObservation> observations;
  CHECK_FALSE(oracle.advance(1.0, observations));
  CHECK(observations.empty());
}

TEST_CASE("The oracle refuses a source that knows no true tracks and names one that does") {
  const FakeSource source;
  CHECK_THROWS_WITH(Oracle({}, {source, 0, ""}), Catch::Matchers::Contains("simulation"));
}
