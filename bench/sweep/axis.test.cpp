#include "bench/sweep/axis.hpp"

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::vector<std::string> texts(const Axis& axis) {
  std::vector<std::string> result;
  for (const AxisValue& value : axis.values) result.push_back(value.text);
  return result;
}

std::vector<std::string> texts(const std::string& json) { return texts(read_axis(parse_json(json), "s").at(0)); }

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("An axis is a list, or a range with equal distances or ratios, of rounded values") {
  CHECK(texts(R"({"key": "a", "values": [1, 0.5, "x", {"b": 1}]})") == Texts{"1", "0.5", "x", "{\"b\":1}"});
  CHECK(texts(R"({"key": "a", "range": {"from": 1, "to": 3}})") == Texts{"1", "2", "3"});
  CHECK(texts(R"({"key": "a", "range": {"from": 0, "to": 1, "step": 0.4}})") == Texts{"0", "0.4", "0.8"});
  CHECK(texts(R"({"key": "a", "range": {"from": 0, "to": 0.3, "step": 0.1}})") == Texts{"0", "0.1", "0.2", "0.3"});
  CHECK(texts(R"({"key": "a", "range": {"from": -1, "to": 1, "count": 3}})") == Texts{"-1", "0", "1"});
  CHECK(texts(R"({"key": "a", "range": {"from": 0.01, "to": 1, "count": 5, "scale": "logarithmic"}})") ==
        Texts{"0.01", "0.0316228", "0.1", "0.316228", "1"});
  CHECK(texts(R"({"key": "a", "range": {"from": 10, "to": 1000, "count": 5, "scale": "logarithmic", "digits": 2}})") ==
        Texts{"10", "32", "100", "320", "1000"});
}

TEST_CASE("An axis on a command line has the same forms") {
  CHECK(texts(parse_axis("a=1..3,7")) == Texts{"1", "2", "3", "7"});
  CHECK(texts(parse_axis("a=0..1:3")) == Texts{"0", "0.5", "1"});
  CHECK(texts(parse_axis("a=1..100:3log,x")) == Texts{"1", "10", "100", "x"});
  CHECK(texts(parse_axis("a=5..5")) == Texts{"5"});
  CHECK(texts(parse_axis("a=[1,2],{\"b\":1,\"c\":2},\"d,e\"")) == Texts{"[1,2]", "{\"b\":1,\"c\":2}", "\"d,e\""});
  const Axis axis = parse_axis("backend.rate=2..3");
  CHECK(axis.name == "backend.rate");
  CHECK(axis.values.at(1).overrides == std::vector<std::string>{"backend.rate=3"});
}

TEST_CASE("Overlays set several keys under one name, and zipped axes keep their names") {
  const ZippedAxes overlay =
      read_axis(parse_json(R"({"name": "motion", "overlays": {"slow": {"a": 1, "b.c": "x"}, "fast": {}}})"), "s");
  REQUIRE(overlay.size() == 1);
  CHECK(overlay[0].name == "motion");
  CHECK(overlay[0].values.at(0).text == "slow");
  CHECK(overlay[0].values.at(0).overrides == std::vector<std::string>{"a=1", "b.c=x"});
  CHECK(overlay[0].values.at(1).overrides.empty());
  const ZippedAxes zipped = read_axis(parse_json(R"({"zip": [{"key": "a", "values": [1, 2]},
                                                              {"key": "b", "name": "c", "values": [3, 4]}]})"),
                                      "s");
  REQUIRE(zipped.size() == 2);
  CHECK(zipped[0].name == "a");
  CHECK(zipped[1].name == "c");
  CHECK(texts(zipped[1]) == Texts{"3", "4"});
}

TEST_CASE("An invalid axis is refused with its place and what was expected") {
  const auto refused = [](const std::string& json, const std::string& message) {
    INFO(json);
    CHECK_THROWS_WITH(read_axis(parse_json(json), "s.json: axes.0"),
                      ContainsSubstring("s.json: axes.0") && ContainsSubstring(message));
  };
  refused(R"({"key": "a", "value": [1]})", "unknown key \"value\"; did you mean \"values\"?");
  refused(R"({"key": "a"})", "expected one of \"values\", \"range\", \"overlays\", \"zip\"");
  refused(R"({"key": "a", "values": [1], "range": {}})", "expected one of");
  refused(R"({"key": "a", "values": []})", "the axis \"a\" has no values");
  refused(R"({"name": "a", "overlays": {}})", "the axis \"a\" has no values");
  refused(R"({"key": "a", "values": 1})", "expected a list of values");
  refused(R"({"key": "a", "values": [1, 2, 1]})", "has the value 1 twice");
  refused(R"({"values": [1]})", "expected a \"key\"");
  refused(R"({"overlays": {"x": {"a": 1}}})", "expected a \"name\"");
  refused(R"({"name": "n", "overlays": {"x": 1}})", "overlays.x: expected an object");
  refused(R"({"key": "a", "range": {"from": 1}})", "\"to\" is missing");
  refused(R"({"key": "a", "range": {"from": 2, "to": 1}})", "expected the smaller value first");
  refused(R"({"key": "a", "range": {"from": 0, "to": 1, "count": 3, "scale": "logarithmic"}})", "values above 0");
  refused(R"({"key": "a", "range": {"from": 1, "to": 2, "scale": "logarithmic"}})", "expected a count");
  refused(R"({"key": "a", "range": {"from": 1, "to": 2, "step": 1, "count": 2}})", "expected a step or a count");
  refused(R"({"key": "a", "range": {"from": 0, "to": 1, "step": 1e-9}})", "more than 100000 values");
  refused(R"({"zip": [{"key": "a", "values": [1, 2, 3]}, {"key": "b", "values": [1, 2]}]})",
          "\"a\" has 3 values and \"b\" 2; expected as many of each");
  refused(R"({"zip": [{"key": "a", "values": [1]}]})", "two axes or more");
  for (const char* const text : {"a", "=1", "a=", "a=1,,2", "a=1,1", "a=3..1"}) {
    INFO(text);
    CHECK_THROWS_WITH(parse_axis(text), ContainsSubstring("--vary " + std::string(text)));
  }
  for (const char* const range : {"1...3", "1..", "1..b", "1..2:1", "0.1..1:0", "0..1:2.5", "0..1:x", "0..1:1000000"}) {
    INFO(range);
    CHECK_THROWS_WITH(parse_axis(std::string("a=") + range),
                      ContainsSubstring("\"" + std::string(range) + "\" is no range"));
  }
  CHECK(parse_axis("a=../b..c").values.at(0).text == "../b..c");
}
