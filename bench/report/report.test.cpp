#include "bench/report/report.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>

#include "bench/report/column.hpp"
#include "bench/report/thinning.hpp"
#include "bench/testing/configs.hpp"
#include "bench/testing/program.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/find_runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string bytes_of(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : base64) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xffU));
  }
  return bytes;
}

/// As the page reads a column.
std::vector<double> numbers(const Json& column) {
  std::vector<double> values;
  if (column.is_array()) return column.get<std::vector<double>>();
  if (column.contains("n")) {
    for (int i = 0; i < column.at("n"); ++i)
      values.push_back(column.at("from").get<double>() + i * column.at("step").get<double>());
    return values;
  }
  if (column.contains("f32")) {
    const std::string bytes = bytes_of(column.at("f32"));
    std::vector<float> single(bytes.size() / sizeof(float));
    std::memcpy(single.data(), bytes.data(), bytes.size());
    return {single.begin(), single.end()};
  }
  const std::string bytes = bytes_of(column.at("i16"));
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto k = static_cast<std::int16_t>(static_cast<unsigned char>(bytes[i]) |
                                             static_cast<unsigned char>(bytes[i + 1]) << 8U);
    values.push_back(k == INT16_MIN ? std::nan("")
                                    : column.at("offset").get<double>() + k * column.at("scale").get<double>());
  }
  return values;
}

std::string run(const std::string& more = "") {
  return "\"$evbench\" run '" + std::string(EVBENCH_CONFIGS) +
         "/examples/simulated_tracks.json' --quiet --out results --set source.duration=3 " + more;
}

/// The data of a page.
Json data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  const std::string text = page.substr(from, page.find("</script>", from) - from);
  CHECK(text.find('<') == std::string::npos);
  return parse_json(text);
}

}  // namespace

TEST_CASE("Columns of a report are read back to a part in 65,000 of their range, times to half a millisecond") {
  for (const std::size_t count : {0U, 1U, 2U, 3U, 100U}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(i == 7 ? std::nan("") : 100.0 + std::sin(0.3 * double(i)));
    const std::vector<double> read = numbers(report::coarse(values));
    REQUIRE(read.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
      if (i == 7) {
        CHECK(std::isnan(read[i]));
      } else {
        CHECK(std::abs(read[i] - values[i]) <= 2.0 / 65000.0);
      }
    }
  }
  const std::vector<double> even = {1.5e9, 1.5e9 + 0.01, 1.5e9 + 0.02}, uneven = {0.0, 0.013, 0.02},
                            late = {1.5e9, 1.5e9 + 0.013, 1.5e9 + 0.02};
  for (const auto& times : {even, uneven, late}) {
    const std::vector<double> read = numbers(report::times(times));
    REQUIRE(read.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(read[i] - times[i]) < 5e-4);
  }
  CHECK(report::thinned(1000, 10).size() == 10);
  CHECK(report::thinned(1000, 10).back() == 999);
  CHECK(report::thinned(5, 10) == std::vector<std::size_t>{0, 1, 2, 3, 4});
}

TEST_CASE("A report has the table's numbers, the trajectory as it was scored, and names as text") {
  const TemporaryFolder folder;
  const std::string label = "<script>alert(1)</script> \"quoted\" & 'more'";
  Json config = parse_json(read_file(std::string(EVBENCH_CONFIGS) + "/examples/simulated_tracks.json"));
  config["name"] = "simulated_tracks";
  config["source"]["duration"] = 3;
  config["backend"]["label"] = label;
  folder.write("config.json", config.dump());
  REQUIRE(evbench::testing::evbench(folder, "run config.json --quiet --tracks --report").exit_code == 0);
  const Json data = data_of(read_file(folder.file("results/simulated_tracks/report.html")));
  CHECK(data.at("format") == "evbench.report");
  REQUIRE(data.at("runs").size() == 1);
  const Json& one = data.at("runs")[0];
  CHECK(one.at("label") == label);
  CHECK(one.at("state") == "ok");
  const RunRecord record = find_runs(std::vector{folder.file("results")}, nullptr).front();
  const Json& cells = data.at("tables")[0].at("rows")[0].at("cells");
  const Json& columns = data.at("tables")[0].at("columns");
  bool found = false;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].value("key", "") != "ate.trans_m.rmse") continue;
    found = true;
    CHECK(cells[i].at("value") == record.final_scores.at("ate").at("trans_m").at("rmse"));
  }
  CHECK(found);
  const Json& estimate = one.at("segments")[0].at("estimate");
  const std::vector<double> t = numbers(estimate.at("t")), error = numbers(estimate.at("error_m"));
  REQUIRE(t.size() == error.size());
  REQUIRE(t.size() == numbers(estimate.at("p")[0]).size());
  double sum = 0.0, count = 0.0;
  for (const double e : error) {
    if (std::isnan(e)) continue;
    sum += e * e;
    count += 1.0;
  }
  CHECK(std::sqrt(sum / count) ==
        Approx(record.final_scores.at("ate").at("trans_m").at("rmse").get<double>()).epsilon(1e-3));
  CHECK(data.at("sequences")[0].at("ground_truth").is_object());
  CHECK(one.at("tracks").at("total") > 10);
  CHECK(one.at("updates").at("total") > 10);
  CHECK(numbers(one.at("segments")[0].at("landmarks")[2]).size() > 10);
}

TEST_CASE("A report shows runs that failed, and runs without ground truth, and replaces reports only") {
  const TemporaryFolder folder;
  REQUIRE(shell(folder, run("--set source.tracks.alive=2")).exit_code != 2);
  REQUIRE(evbench::testing::evbench(folder, "report results").exit_code == 0);
  const Json failed = data_of(read_file(folder.file("results/report.html")));
  CHECK(failed.at("runs")[0].at("state") == "failed");
  CHECK(failed.at("runs")[0].at("reason").get<std::string>().size() > 10);
  CHECK(failed.at("runs")[0].at("segments").empty());
  CHECK(evbench::testing::evbench(folder, "report results").exit_code == 0);  // again
  folder.write("mine.html", "<p>mine</p>");
  const Outcome refused = evbench::testing::evbench(folder, "report results --out mine.html");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("mine.html") && ContainsSubstring("--force"));
  CHECK(read_file(folder.file("mine.html")) == "<p>mine</p>");

  REQUIRE(shell(folder, run("--set name=blind")).exit_code == 0);
  REQUIRE(shell(folder, "rm results/blind/*/groundtruth.tum && \"$evbench\" report results/blind").exit_code == 0);
  const Json blind = data_of(read_file(folder.file("results/blind/report.html")));
  CHECK(blind.at("sequences")[0].at("ground_truth").is_null());
  CHECK_THAT(blind.at("runs")[0].at("segments")[0].at("note").get<std::string>(), ContainsSubstring("no ground truth"));
}

TEST_CASE("A report of another protocol has its curves, too, and damaged files cost no more than their part") {
  const TemporaryFolder folder;
  REQUIRE(shell(folder, run("--set 'backend={\"type\": \"gp_map\"}'")).exit_code == 0);
  REQUIRE(evbench::testing::evbench(folder, "report results --protocol evo").exit_code == 0);
  const Json evo = data_of(read_file(folder.file("results/report.html")));
  double sum = 0.0, count = 0.0;
  for (const double e : numbers(evo.at("runs")[0].at("segments")[0].at("estimate").at("error_m"))) {
    if (std::isnan(e)) continue;
    sum += e * e;
    count += 1.0;
  }
  const Json& columns = evo.at("tables")[0].at("columns");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string key = columns[i].value("key", "");
    if (key != "ate.trans_m.rmse" && key != "common.ate.trans_m.rmse") continue;
    const double value = evo.at("tables")[0].at("rows")[0].at("cells")[i].at("value");
    CHECK(std::sqrt(sum / count) == Approx(value).epsilon(key == "ate.trans_m.rmse" ? 0.001 : 0.05));
  }
  REQUIRE(shell(folder,
                "cd results/*/gp_map-*/ && for file in velocities.txt covariance.txt map.ply causal_poses.txt; do "
                "echo damaged > $file; done; printf 't_s,update_ms\\n0.1,3\\n' > timing.csv")
              .exit_code == 0);
  const Outcome outcome = evbench::testing::evbench(folder, "report results");
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const Json damaged = data_of(read_file(folder.file("results/report.html")));
  CHECK(damaged.at("remarks").size() >= 4);
  CHECK(damaged.at("runs")[0].at("state") != "not run");
  CHECK(damaged.at("runs")[0].at("segments").size() == 1);
  folder.write("results/simulated_tracks/report.html", "mine");
  CHECK(shell(folder, run("--report")).exit_code == 2);
  CHECK(read_file(folder.file("results/simulated_tracks/report.html")) == "mine");
}

TEST_CASE("A report of a sweep has a figure against its axis, whose points lead to their runs") {
  const TemporaryFolder folder;
  const Outcome outcome =
      shell(folder, "\"$evbench\" sweep '" + std::string(EVBENCH_CONFIGS) +
                        "/examples/simulated_tracks.json' --vary backend.batch_duration=0.05,0.1 --vary seed=1..2 "
                        "--set source.duration=2 --set name=batches --quiet --report --out results");
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const Json data = data_of(read_file(folder.file("results/batches/report.html")));
  CHECK(data.at("runs").size() == 4);
  CHECK(data.at("tables").size() == 2);
  const Json& figure = data.at("figures")[0];
  CHECK(figure.at("title") == "Against backend.batch_duration");
  std::size_t points = 0;
  for (const Json& mark : figure.at("figure").at("panels")[0].at("marks")) {
    if (mark.at("kind") != "points") continue;
    points += mark.at("runs").size();
    for (const Json& runs : mark.at("runs")) CHECK(runs.size() == 2);
  }
  CHECK(points == 2);
}
