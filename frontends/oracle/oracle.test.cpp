#include "frontends/oracle/oracle.hpp"

#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

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

TEST_CASE("The oracle passes on the source's tracks up to the time asked for, each once") {
  FakeSource source;
  source.tracks = {{0, 0.1, {1, 1}, 1.0}, {1, 0.2, {2, 2}, 1.0}, {0, 0.3, {3, 3}, 1.0}};
  const auto oracle =
      registered_plugins().of<FrontEnd>().find("oracle", "test").make(Json::object(), {source, 0, "", "test"});
  TrackBatch batch;
  CHECK(oracle->advance({0.2}, batch));
  CHECK(batch.observations.size() == 2);
  CHECK(oracle->advance({0.25}, batch));
  CHECK(batch.observations.empty());
  CHECK_FALSE(oracle->advance({1.0}, batch));
  REQUIRE(batch.observations.size() == 1);
  CHECK(batch.observations[0].t == 0.3);
}

TEST_CASE("The oracle of a source without tracks has nothing to give") {
  FakeSource source;
  source.tracks.emplace();
  Oracle oracle({}, {source, 0, ""});
  TrackBatch batch;
  CHECK_FALSE(oracle.advance({1.0}, batch));
  CHECK(batch.observations.empty());
}

TEST_CASE("The oracle refuses a source that knows no true tracks and names one that does") {
  const FakeSource source;
  CHECK_THROWS_WITH(Oracle({}, {source, 0, ""}), Catch::Matchers::ContainsSubstring("simulation"));
}
