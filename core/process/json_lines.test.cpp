#include "core/process/json_lines.hpp"

#include <cmath>
#include <random>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::process;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string text_of(const Line& line) { return {line.data(), line.size()}; }

template <class Read>
std::string refusal(const std::string& json, Read read) {
  try {
    read(parse_json(json));
  } catch (const MessageError& error) {
    return error.what();
  }
  return "";
}

std::vector<TrackObservation> rows(const Json& json) { return observations(json); }

}  // namespace

TEST_CASE("Observations are read back as the numbers that were written") {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  UndistortedBatch batch;
  double t = 0.0;
  for (int i = 0; i < 1000; ++i) {
    t += std::exp(5.0 * normal(random) - 8.0);
    batch.observations.push_back({static_cast<TrackId>(random() >> 1U),
                                  t,
                                  {1e3 * normal(random), std::exp(30.0 * normal(random))},
                                  std::exp(normal(random))});
    batch.ended.push_back({i, t});
  }
  batch.until = t;
  Line line;
  line.push_back('{');
  CHECK(write_batch(line, batch) == 0);
  line.push_back('}');
  const Json message = parse_object(text_of(line));
  CHECK(message.at("until").get<double>() == t);
  const std::vector<TrackObservation> read = observations(message.at("observations"));
  REQUIRE(read.size() == batch.observations.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    REQUIRE(read[i].track == batch.observations[i].track);
    REQUIRE(read[i].t == batch.observations[i].t);
    REQUIRE(read[i].pixel == batch.observations[i].pixel);
    REQUIRE(read[i].noise == batch.observations[i].noise);
  }
  const std::vector<TrackEnd> ended = track_ends(message.at("ended"));
  CHECK(ended.size() == 1000);
  CHECK(ended.back().t == t);
}

TEST_CASE("Covariances are written beside the observations where any has one, and read back exactly") {
  UndistortedBatch batch;
  batch.until = 0.5;
  batch.observations = {{1, 0.1, {1.0, 2.0}, PixelNoise(0.5, -0.2, 0.3)}, {2, 0.2, {3.0, 4.0}, 0.7}};
  Line line;
  line.push_back('{');
  CHECK(write_batch(line, batch) == 0);
  line.push_back('}');
  const Json message = parse_object(text_of(line));
  const std::vector<TrackObservation> read = observations(message.at("observations"), &message.at("covariances"));
  REQUIRE(read.size() == 2);
  CHECK(read[0].noise == batch.observations[0].noise);
  CHECK(read[1].noise == batch.observations[1].noise);

  const auto with = [&](const std::string& covariances) {
    return refusal(covariances, [&](const Json& json) { observations(message.at("observations"), &json); });
  };
  CHECK_THAT(with("[[1,0,1]]"), ContainsSubstring("covariances: 1 of them for 2 observations"));
  CHECK_THAT(with("[[1,0,1],[1,2,1]]"),
             ContainsSubstring("covariances[1]: expected a positive definite covariance xx xy yy, found [1,2,1]"));
  CHECK_THAT(with("[[1,0,1],[1,0]]"), ContainsSubstring("covariances[1]: expected 3 numbers"));
}

TEST_CASE("Observations that are not finite are left out of a line and counted") {
  UndistortedBatch batch;
  batch.observations = {{1, 0.1, {1, 2}, 1.0}, {2, 0.1, {NAN, 2}, 1.0}, {3, 0.1, {1, INFINITY}, 1.0}};
  batch.until = 0.5;
  Line line;
  CHECK(write_batch(line, batch) == 2);
  CHECK(text_of(line) == R"("until":0.5,"observations":[[1,0.1,1,2,1]],"ended":[])");
}

TEST_CASE("Events are written in seconds that are exact to the microsecond") {
  Line line;
  const std::vector<Event> events = {{12345, 3, 4, true}, {1000000, 0, 65535, false}, {3000000017, 1, 1, true}};
  write_events(line, events);
  CHECK(text_of(line) == "[[0.012345,3,4,1],[1,0,65535,0],[3000.000017,1,1,1]]");
  Line none;
  write_events(none, {});
  CHECK(text_of(none) == "[]");
}

TEST_CASE("Feedback is read back as it was written") {
  Feedback feedback;
  feedback.t = 0.25;
  feedback.state = TrackingState::degraded;
  feedback.outliers = {7, 9};
  feedback.world = 2;
  ControlState newest_state;
  newest_state.t = 0.2;
  newest_state.T = se3::exp((Vector6() << 0.1, 0.2, 0.3, 1, 2, 3).finished());
  newest_state.velocity << 1, 2, 3, 4, 5, 0.1;
  feedback.newest = newest_state;
  feedback.covariance = Matrix12::Identity() * 0.1;
  feedback.expected = {{4, {1, 2, 3}, {10.5, 20.25}, Matrix2::Identity()}};
  Line line;
  write_feedback(line, feedback);
  const Json message = parse_object(text_of(line));
  CHECK(tracking_state(message.at("state")) == TrackingState::degraded);
  const MovingPose read = moving_pose(message.at("newest"), {"newest"});
  CHECK(read.pose.t == 0.2);
  CHECK(read.pose.T.p == newest_state.T.p);
  CHECK((read.pose.T.q.coeffs() - newest_state.T.q.coeffs()).norm() < 1e-15);
  CHECK(read.velocity == newest_state.velocity);
  CHECK(covariance(message.at("covariance")) == *feedback.covariance);
  const std::vector<UndistortedFeature> expected = expected_features(message.at("expected"));
  REQUIRE(expected.size() == 1);
  CHECK(expected[0].pixel == Vector2(10.5, 20.25));
  CHECK(dump_json(message.at("outliers")) == "[7,9]");
  CHECK(message.at("world") == 2);
  feedback.newest->T.p.x() = NAN;
  Line without;
  write_feedback(without, feedback);
  CHECK_FALSE(parse_object(text_of(without)).contains("newest"));
}

TEST_CASE("An invalid message is refused by a sentence that names the place") {
  CHECK_THROWS_WITH(parse_object("Hello"), ContainsSubstring("expected one JSON object a line, found Hello"));
  CHECK_THROWS_WITH(parse_object("{\"a\": NaN}"), ContainsSubstring("JSON has no NaN"));
  CHECK_THROWS_WITH(parse_object("[1]"), ContainsSubstring("expected a JSON object, found [1]"));
  CHECK_THROWS_WITH(parse_object(""), ContainsSubstring("expected one JSON object"));
  CHECK_THROWS_WITH(parse_object("{\"a\": 1e999}"), ContainsSubstring("expected one JSON object"));
  CHECK_THROWS_WITH(parse_object("{\"a\": \"\xff\"}"), ContainsSubstring("expected one JSON object"));
  CHECK_THROWS_WITH(check_keys(parse_json(R"({"outlier": 1})"), {"state", "outliers"}),
                    "unknown key \"outlier\"; did you mean \"outliers\"?");
  CHECK_THROWS_WITH(require(Json::object(), "state"), "\"state\" is missing in {}");
  CHECK(refusal("[[1,0.1,5,5]]", rows) == "observations[0]: expected 5 numbers (track t x y sigma), found [1,0.1,5,5]");
  CHECK_THAT(refusal("[[1,0.1,5,5,0]]", rows), ContainsSubstring("a sigma above 0"));
  CHECK_THAT(refusal("[[1.5,0.1,5,5,1]]", rows), ContainsSubstring("an integer"));
  CHECK_THAT(refusal("[[18446744073709551615,0.1,5,5,1]]", rows), ContainsSubstring("an integer of 64 bits"));
  CHECK_THAT(refusal("[[1,\"0.1\",5,5,1]]", rows), ContainsSubstring("found [1,\"0.1\",5,5,1]"));
  CHECK_THAT(refusal("[[1,null,5,5,1]]", rows), ContainsSubstring("found [1,null,5,5,1]"));
  CHECK_THAT(refusal("[[1,0.2,5,5,1],[2,0.1,5,5,1]]", rows),
             ContainsSubstring("observations[1]: time 0.1 s is before"));
  CHECK_THAT(refusal("{}", rows), ContainsSubstring("expected a list, found {}"));
  CHECK_THAT(refusal("[[1]]", track_ends), ContainsSubstring("ended[0]: expected 2 numbers (track t)"));
  CHECK_THAT(refusal("\"lots\"", tracking_state), ContainsSubstring("unknown state \"lots\"; did you mean \"lost\"?"));
  CHECK_THAT(refusal("[1,2]", covariance), ContainsSubstring("144 numbers"));
  CHECK_THAT(refusal("[[0.2,0.1,\"x\"]]", degraded_spans), ContainsSubstring("a span that ends after it begins"));
  const auto causal = [](const Json& value) { poses(value, "causal"); };
  CHECK_THAT(refusal("[[0,0,0,0,0,0,0,0.9]]", causal), ContainsSubstring("causal[0]: the quaternion's norm is 0.9"));
  CHECK_THAT(refusal("[[0,0,0,0,0,0,0,1],[0,0,0,0,0,0,0,1]]", causal),
             ContainsSubstring("causal[1]: time 0 s is not after"));
}

TEST_CASE("A whole number with a decimal point is an integer, as numeric libraries write them") {
  CHECK(integer(parse_json("7.0"), {"track"}) == 7);
  CHECK(integer(parse_json("-7"), {"track"}) == -7);
  CHECK(pose(parse_json("[1,2,3,4,0,0,0,1.0005]"), {"causal"}).T.q.norm() == Approx(1.0).epsilon(1e-15));
}
