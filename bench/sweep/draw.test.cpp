#include "bench/sweep/draw.hpp"

#include <cmath>
#include <map>
#include <set>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Drawn draw_text(const std::string& json, std::uint64_t seed) { return draw(parse_json(json), seed, "draw"); }

double number_of(const std::string& override) { return std::stod(override.substr(override.find('=') + 1)); }

}  // namespace

TEST_CASE("Numbers are drawn from their distributions, the same for the same seed") {
  std::set<double> whole;
  double sum = 0.0, sum_of_logs = 0.0;
  constexpr int kSeeds = 4000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::string json = R"({"a": {"uniform": [2, 4]}, "b": {"log_uniform": [0.01, 1]}, "c": {"whole": [-1, 2]}})";
    const Drawn drawn = draw_text(json, static_cast<std::uint64_t>(seed));
    REQUIRE(drawn.overrides.size() == 3);
    CHECK(drawn.overrides == draw_text(json, static_cast<std::uint64_t>(seed)).overrides);
    CHECK(drawn.overrides[0].starts_with("a="));
    sum += number_of(drawn.overrides[0]);
    sum_of_logs += std::log10(number_of(drawn.overrides[1]));
    whole.insert(number_of(drawn.overrides[2]));
  }
  CHECK(sum / kSeeds == Approx(3.0).margin(0.04));
  CHECK(sum_of_logs / kSeeds == Approx(-1.0).margin(0.04));
  CHECK(whole == std::set<double>{-1, 0, 1, 2});
}

TEST_CASE("A property is one of its sets, each once in as many seeds as there are sets, with numbers drawn in it") {
  std::map<std::string, int> counts;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const Drawn drawn = draw_text(
        R"({"texture": {"fine": {"k": {"uniform": [0, 1]}}, "coarse": {"k": {"uniform": [5, 6]}, "l": "x"}, "none": {}}})",
        seed);
    REQUIRE(drawn.properties.size() == 1);
    CHECK(drawn.properties[0].name == "texture");
    const std::string& text = drawn.properties[0].text;
    ++counts[text];
    if (text == "none") CHECK(drawn.overrides.empty());
    if (text == "fine") CHECK(number_of(drawn.overrides.at(0)) <= 1.0);
    if (text == "coarse") CHECK(number_of(drawn.overrides.at(0)) >= 5.0);
    if (text == "coarse") CHECK(drawn.overrides.at(1) == "l=x");
  }
  for (const auto& [text, count] : counts) CHECK(count == 1000);
}

TEST_CASE("What is drawn for an item does not depend on the others") {
  const Drawn alone = draw_text(R"({"b": {"uniform": [0, 1]}})", 7);
  const Drawn beside = draw_text(R"({"a": {"uniform": [0, 1]}, "b": {"uniform": [0, 1]}})", 7);
  CHECK(alone.overrides.at(0) == beside.overrides.at(1));
  CHECK(beside.overrides.at(0).substr(1) != beside.overrides.at(1).substr(1));
}

TEST_CASE("What can't be drawn from is refused with its place") {
  const auto refuses = [](const std::string& json, const std::string& text) {
    CHECK_THROWS_WITH(draw_text(json, 1), Catch::Matchers::ContainsSubstring(text));
  };
  refuses(R"([1])", "draw: expected an object");
  refuses(R"({"a": 3})", "draw.a: expected a distribution");
  refuses(R"({"a": {}})", "draw.a");
  refuses(R"({"a": {"uniform": [2, 1]}})", "draw.a: {\"uniform\":[2,1]}; expected {\"uniform\": [A, B]} with A < B");
  refuses(R"({"a": {"log_uniform": [0, 1]}})", "above 0");
  refuses(R"({"a": {"whole": [0.5, 2]}})", "draw.a");
  refuses(R"({"a": {"x": 3}})", "draw.a.x: expected an object");
  refuses(R"({"a": {"x": {"k": {"uniform": ["p", 1]}}, "y": {}}})", "draw.a.x.k");
}
