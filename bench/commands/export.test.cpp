#include <filesystem>
#include <set>

#include "bench/testing/program.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A folder with the config c.json of the short simulated sequence.
struct Sequence {
  TemporaryFolder folder;

  Sequence() { folder.write("c.json", dump_json(short_config())); }
  Outcome run(const std::string& arguments) const { return testing::evbench(folder, arguments); }
  void refused(const std::string& arguments, const std::string& message) const {
    INFO(arguments);
    const Outcome outcome = run("export " + arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  }
};

}  // namespace

TEST_CASE("A simulated sequence is exported whole, and can be run from its files", "[slow]") {
  const Sequence sequence;
  REQUIRE(sequence.run("export c.json --groundtruth groundtruth.txt --tracks tracks.txt --calib calib.txt").exit_code ==
          0);
  const PoseTrajectory truth = read_tum(sequence.folder.file("groundtruth.txt"));
  CHECK(truth.start() <= 0.0);
  CHECK(truth.end() >= 3.0);
  const auto tracks = read_tracks(sequence.folder.file("tracks.txt"), 240, 180).observations;
  CHECK(tracks.size() > 1000);
  Json config = short_config();
  config["name"] = "files";
  config["source"] = {{"type", "recording"}, {"folder", "."}, {"width", 240}, {"height", 180}};
  config["frontend"] = {{"type", "recorded"}, {"tracks", "tracks.txt"}};
  sequence.folder.write("files.json", dump_json(config));
  REQUIRE(sequence.run("run files.json --quiet").exit_code == 0);
  const std::string run = *names_in(sequence.folder.file("results/files")).begin();
  const Json metrics = parse_json(read_file(sequence.folder.file("results/files/" + run + "/metrics.json")));
  CHECK(metrics.at("final").at("ate").at("trans_percent").get<double>() < 2.0);
  const std::string first = read_file(sequence.folder.file("tracks.txt"));
  REQUIRE(sequence.run("export c.json --tracks tracks.txt --set seed=2 --force").exit_code == 0);
  CHECK(read_file(sequence.folder.file("tracks.txt")) != first);
}

TEST_CASE("A run's exported estimate and errors agree with its scores", "[slow]") {
  const Sequence sequence;
  REQUIRE(sequence.run("run c.json --quiet").exit_code == 0);
  const std::string run =
      sequence.folder.file("results/short/" + *names_in(sequence.folder.file("results/short")).begin());
  REQUIRE(sequence.run("export '" + run + "' --aligned a.txt --errors e.csv --groundtruth g.txt --tracks t.txt")
              .exit_code == 0);
  const Json scores = parse_json(read_file(run + "/metrics.json")).at("final");
  const std::string csv = read_file(sequence.folder.file("e.csv"));
  CHECK(std::ranges::count(csv, '\n') == 1 + scores.at("pairs").get<std::ptrdiff_t>());
  CHECK(read_tum(sequence.folder.file("a.txt")).size() == read_tum(run + "/final.tum").size());
  REQUIRE(sequence.run("eval g.txt a.txt --interpolate --json s.json --t_start 0 --t_end 3").exit_code == 0);
  const Json aligned = parse_json(read_file(sequence.folder.file("s.json"))).at("final");
  CHECK(aligned.at("ate").at("trans_m").at("rmse").get<double>() ==
        Approx(scores.at("ate").at("trans_m").at("rmse").get<double>()).epsilon(1e-6));
  REQUIRE(sequence.run("export '" + run + "' --causal --aligned causal.txt").exit_code == 0);
  CHECK(read_file(sequence.folder.file("causal.txt")) != read_file(sequence.folder.file("a.txt")));
}

TEST_CASE("A run is exported as evo's result archive, which reads back as evo reads it", "[slow]") {
  const Sequence sequence;
  REQUIRE(sequence.run("run c.json --quiet").exit_code == 0);
  const std::string run =
      sequence.folder.file("results/short/" + *names_in(sequence.folder.file("results/short")).begin());
  const Json scores = parse_json(read_file(run + "/metrics.json")).at("final");
  const std::pair<std::string, Json> expected[] = {{"ape_trans", scores.at("ate").at("trans_m")},
                                                   {"ape_rot", scores.at("ate").at("rot_deg")},
                                                   {"rpe_trans", scores.at("rpe").at("trans_m")},
                                                   {"rpe_rot", scores.at("rpe").at("rot_deg")}};
  for (const auto& [name, statistics] : expected) {
    INFO(name);
    REQUIRE(sequence.run("export '" + run + "' --evo " + name + ".zip --evo-error " + name).exit_code == 0);
    const Outcome read =
        shell(sequence.folder, "/usr/bin/python3 '" EVBENCH_READERS "/evo_result.py' " + name + ".zip");
    INFO(read.err);
    REQUIRE(read.exit_code == 0);
    const Json result = parse_json(read.out);
    CHECK(result.at("stats").at("rmse") == statistics.at("rmse"));
    CHECK(result.at("rmse").get<double>() == Approx(statistics.at("rmse").get<double>()));
    CHECK(result.at("errors") == statistics.at("n"));
    CHECK(result.at("info").at("est_name") == "bundle_adjustment");
    CHECK(result.at("scale").get<double>() == Approx(scores.at("scale").get<double>()));
    CHECK(result.at("last_time").get<double>() == Approx(scores.at("span_s").at(1).get<double>()));
    CHECK(result.at("path").get<double>() == Approx(scores.at("path_m").get<double>()));
  }
  REQUIRE(sequence.run("export '" + run + "' --evo again.zip").exit_code == 0);
  CHECK(read_file(sequence.folder.file("again.zip")) == read_file(sequence.folder.file("ape_trans.zip")));
}

TEST_CASE("A run is exported in rpg_trajectory_evaluation's layout, which gives the same error when read as it does",
          "[slow]") {
  const Sequence sequence;
  REQUIRE(sequence.run("run c.json --quiet").exit_code == 0);
  const std::string run =
      sequence.folder.file("results/short/" + *names_in(sequence.folder.file("results/short")).begin());
  REQUIRE(sequence.run("export '" + run + "' --rpg rpg").exit_code == 0);
  CHECK(names_in(sequence.folder.file("rpg")) ==
        std::set<std::string>{"stamped_groundtruth.txt", "stamped_traj_estimate.txt", "eval_cfg.yaml"});
  const Outcome read = shell(sequence.folder, "/usr/bin/python3 '" EVBENCH_READERS "/rpg_layout.py' rpg");
  INFO(read.err);
  REQUIRE(read.exit_code == 0);
  const Json result = parse_json(read.out);
  CHECK(result.at("align_type") == "sim3");
  CHECK(result.at("align_num_frames") == -1);
  REQUIRE(sequence.run("eval '" + run + "/groundtruth.tum' '" + run + "/final.tum' -as --t_max_diff 0.02 --json s.json")
              .exit_code == 0);
  const Json scores = parse_json(read_file(sequence.folder.file("s.json"))).at("final");
  CHECK(result.at("pairs") == scores.at("pairs"));
  CHECK(result.at("rmse").get<double>() ==
        Approx(scores.at("ate").at("trans_m").at("rmse").get<double>()).epsilon(1e-6));
  REQUIRE(sequence.run("score results --set evaluation.alignment=origin --quiet").exit_code == 0);
  const Outcome refused = sequence.run("export '" + run + "' --rpg other");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("rpg_trajectory_evaluation does not align by \"origin\""));
}

TEST_CASE("An impossible export is an error that says what is expected, and no file is replaced", "[slow]") {
  const Sequence sequence;
  sequence.refused("c.json", "nothing to export; expected at least one of --groundtruth");
  sequence.refused("c.json --errors e.csv",
                   "c.json: --aligned, --errors, --evo, --rpg and --at are of a run; expected its folder");
  sequence.refused("c.json --evo e.txt", "--evo e.txt: expected a name that ends with .zip");
  sequence.refused("none.json --tracks t.txt", "none.json: no such file");
  sequence.refused(". --errors e.csv", ".: has no metrics.json; expected the folder of a run");
  sequence.folder.write("t.txt", "mine");
  sequence.refused("c.json --tracks t.txt", "t.txt: exists already; --force replaces it");
  CHECK(read_file(sequence.folder.file("t.txt")) == "mine");
  write_recording(sequence.folder);
  sequence.refused("recording.json --groundtruth none.txt --tracks none2.txt",
                   "recording.json: its source knows no tracks; expected a simulated one");
  CHECK_FALSE(std::filesystem::exists(sequence.folder.file("none.txt")));
}
