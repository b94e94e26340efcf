#include "core/support/nearest.hpp"

#include <vector>

#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("The nearest name is the one with the fewest edits, if it is similar enough") {
  const std::vector<std::string> names = {"duration", "seed", "camera"};
  CHECK(nearest_name("duratoin", names) == "duration");
  CHECK(nearest_name("sed", names) == "seed");
  CHECK(nearest_name("camera", names) == "camera");
  CHECK(nearest_name("quaternion_order", names).empty());
  CHECK(nearest_name("x", {}).empty());
}

TEST_CASE("A suggestion offers the nearest name, or all of them") {
  const std::vector<std::string> names = {"huber", "cauchy"};
  CHECK(suggestion("hubert", names) == "; did you mean \"huber\"?");
  CHECK(suggestion("geman_mcclure", names) == "; known: huber, cauchy");
}

TEST_CASE("A suggestion from many names offers those that contain the word, then the nearest") {
  std::vector<std::string> names = {"ate.rmse", "times.max", "rpe.rmse"};
  for (int i = 0; i < 60; ++i) names.push_back("a rather long name, number " + std::to_string(i));
  CHECK(suggestion("zzzz", {names.data(), 2}) == "; known: ate.rmse, times.max");
  const std::string many = suggestion("rmse", names);
  CHECK(many.starts_with("; the most similar of 63: ate.rmse, rpe.rmse, times.max, "));
  CHECK(many.size() < 250);
}

TEST_CASE("A path with missing parts matches the shortest, first one that contains its parts") {
  const std::vector<std::string> names = {"common.ate.trans_m.rmse", "ate.trans_m.rmse", "ate.rot_deg.rmse",
                                          "times.max"};
  CHECK(nearest_name("ate.rmse", names) == "ate.trans_m.rmse");
  CHECK(nearest_name("common.rmse", names) == "common.ate.trans_m.rmse");
  CHECK(nearest_name("rmse.ate", names).empty());
  CHECK(nearest_name("rmse", names).empty());  // could be any
}
