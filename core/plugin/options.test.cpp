#include "core/plugin/options.hpp"

#include "core/plugin/write_options.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

namespace evbench {
namespace {

struct Inner {
  double width = 1.5;
  void declare(OptionSet& set) { set.add("width", width, "width [px]").above(0.0); }
};

struct Options {
  double rate = 20.0;
  int count = 3;
  bool on = true;
  std::string loss = "none";
  enum class Rule { rate, motion } rule = Rule::rate;
  std::vector<double> range;
  std::vector<double> weights = {1.0, 2.0};
  std::string path;
  Inner inner;
  void declare(OptionSet& set) {
    set.add("rate", rate, "rate [Hz]").range(0.1, 100.0);
    set.add("count", count, "how many").range(0);
    set.add("on", on, "whether");
    set.add("loss", loss, "robust loss").choices({"none", "huber"});
    set.add("rule", rule, {"rate", "motion"}, "when");
    set.add("range", range, "from, to [s]").size(2).rising();
    set.add("weights", weights, "two weights").size(2);
    set.add("path", path, "a file").required();
    set.group("inner", inner, "more");
  }
};

Options read(const char* text) { return read_options<Options>(parse_json(text), "c.json: x"); }

}  // namespace

TEST_CASE("Options given in JSON replace their defaults, also in nested objects") {
  const Options o = read(R"({"path": "a", "rate": 50, "range": [1, 2], "inner": {"width": 2}})");
  CHECK(o.rate == 50.0);
  CHECK(o.count == 3);
  CHECK(o.range == std::vector<double>{1.0, 2.0});
  CHECK(o.inner.width == 2.0);
}

TEST_CASE("Writing options and reading them again changes nothing") {
  const Options options = read(R"({"path": "a", "loss": "huber", "rule": "motion", "on": false})");
  CHECK(options.rule == Options::Rule::motion);
  const Json json = write_options(options);
  CHECK(json["rule"] == "motion");
  CHECK(write_options(read_options<Options>(json, "")) == json);
  CHECK(json["loss"] == "huber");
  CHECK(json["inner"]["width"] == 1.5);
}

TEST_CASE("Invalid options are refused with their place and the expected value") {
  using Catch::Matchers::ContainsSubstring;
  CHECK_THROWS_WITH(read(R"({"path": "a", "rte": 5})"),
                    ContainsSubstring("c.json: x") && ContainsSubstring("\"rte\"") && ContainsSubstring("\"rate\""));
  CHECK_THROWS_WITH(read(R"({"path": "a", "rate": 500})"),
                    ContainsSubstring("x.rate") && ContainsSubstring("0.1 to 100"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "rate": "5"})"),
                    ContainsSubstring("expected number") && ContainsSubstring("\"5\""));
  CHECK_THROWS_WITH(read(R"({"path": "a", "count": 1.5})"), ContainsSubstring("expected integer"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "loss": "hubert"})"), ContainsSubstring("did you mean \"huber\""));
  CHECK_THROWS_WITH(read(R"({"path": "a", "rule": "moton"})"),
                    ContainsSubstring("x.rule") && ContainsSubstring("mean \"motion\""));
  CHECK_THROWS_WITH(read(R"({"path": "a", "rule": 1})"), ContainsSubstring("expected text"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "range": [1]})"), ContainsSubstring("expected 2 numbers"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "weights": []})"), ContainsSubstring("expected 2 numbers"));
  CHECK(read(R"({"path": "a", "range": []})").range.empty());
  CHECK_THROWS_WITH(read(R"({"path": "a", "range": [2, 2]})"),
                    ContainsSubstring("x.range: is [2,2]; expected rising numbers"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "inner": {"width": 0}})"),
                    ContainsSubstring("inner.width") && ContainsSubstring("> 0"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "inner": 3})"), ContainsSubstring("expected an object"));
  CHECK_THROWS_WITH(read("{}"), ContainsSubstring("\"path\" is missing"));
}

TEST_CASE("A place in a message names the file, then the keys") {
  using Catch::Matchers::ContainsSubstring;
  CHECK_THROWS_WITH(read_options<Options>(parse_json(R"({"rate": 0})"), "c.json"),
                    ContainsSubstring("c.json: rate: 0 is"));
  CHECK_THROWS_WITH(read(R"({"path": "a", "inner": {"width": 0}})"), ContainsSubstring("c.json: x.inner.width: 0 is"));
}

TEST_CASE("Relative paths among the options become relative to a folder") {
  struct Files {
    std::string file, other, name;
    void declare(OptionSet& set) {
      set.add("file", file, "a file").path();
      set.add("other", other, "a file").path();
      set.add("name", name, "no file");
    }
  } files{"a/../b.txt", "", "c"};
  OptionSet set;
  files.declare(set);
  set.anchor_paths("/folder");
  CHECK(files.file == "/folder/b.txt");
  CHECK(files.other.empty());
  CHECK(files.name == "c");
}

TEST_CASE("Description and schema name every option with its default and bounds") {
  Options o;
  OptionSet set;
  o.declare(set);
  using Catch::Matchers::ContainsSubstring;
  CHECK_THAT(set.describe(),
             ContainsSubstring("inner.width") && ContainsSubstring("robust loss") && ContainsSubstring("0.1 to 100"));
  CHECK_THAT(set.describe(), ContainsSubstring("\ninner. "));  // a heading with the group's text
  std::istringstream lines(set.describe());
  for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 100);
  const Json schema = set.schema();
  CHECK(schema["properties"]["rate"]["maximum"] == 100.0);
  CHECK(schema["properties"]["inner"]["properties"]["width"]["exclusiveMinimum"] == 0.0);
  CHECK(schema["properties"]["loss"]["enum"].size() == 2);
  CHECK(schema["properties"]["rule"]["enum"] == Json::array({"rate", "motion"}));
  CHECK(schema["properties"]["weights"]["minItems"] == 2);
  CHECK(schema["properties"]["weights"]["maxItems"] == 2);
  CHECK(schema["properties"]["range"]["anyOf"].size() == 2);  // two items or none
  CHECK(schema["required"] == Json::array({"path"}));
  CHECK(schema["additionalProperties"] == false);
}

}  // namespace evbench
