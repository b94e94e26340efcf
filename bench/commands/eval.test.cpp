#include <fmt/format.h>

#include <filesystem>

#include "bench/commands/commands.hpp"
#include "bench/testing/program.hpp"
#include "core/data/robotevt.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/scores.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

/// Files of a ground truth and of an estimate that is off by a known similarity and small errors.
struct Trajectories {
  TemporaryFolder folder;
  std::string ground_truth = folder.file("truth.txt");
  std::string estimate = folder.file("estimate.txt");
  std::string json = folder.file("scores.json");

  Trajectories() {
    const PoseTrajectory truth = sample(wavy_pose, 200, 0.01);
    write_file(ground_truth, format_tum(truth));
    write_file(estimate, format_tum(disturbed(seen_from(truth, {2.0, {so3::exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}}}))));
  }

  /// Runs `evbench eval` with these options and returns the output of --json.
  Json eval(const std::string& options) const {
    CLI::App app;
    add_eval(app);
    app.parse("eval " + ground_truth + " " + estimate + " --force --json " + json + " " + options);
    return parse_json(read_file(json));
  }
};

}  // namespace

TEST_CASE("eval aligns as evo's options say") {
  const Trajectories files;
  const auto method = [&](const std::string& options) {
    return files.eval(options).at("final").at("alignment").at("method").get<std::string>();
  };
  CHECK(method("") == "none");
  CHECK(method("-a") == "se3");
  CHECK(method("--align --correct_scale") == "sim3");
  CHECK(method("-s") == "scale");
  CHECK(method("--align_origin") == "origin");
  CHECK(method("--alignment yaw") == "yaw");
  CHECK(files.eval("-as").at("final").at("scale").get<double>() == Approx(2.0).epsilon(0.05));
  CHECK(files.eval("-as --n_to_align 20").at("final").at("alignment").at("poses") == 20);
  CHECK_THROWS_AS(method("-a --align_origin"), CLI::ParseError);
  CHECK_THROWS_AS(method("--alignment sim4"), CLI::ParseError);
}

TEST_CASE("eval takes relative errors over one frame, consecutively, by default") {
  const Trajectories files;
  const Json usual = files.eval("").at("final").at("rpe");
  CHECK(usual.at("delta") == 1.0);
  CHECK(usual.at("delta_unit") == "frames");
  CHECK(usual.at("pairing") == "consecutive");
  CHECK(usual.at("pairs") == 199);
  const Json seconds = files.eval("-d 0.1 -u s --all_pairs -t 0.05").at("final").at("rpe");
  CHECK(seconds.at("delta_unit") == "seconds");
  CHECK(seconds.at("pairs") == 190);
  CHECK(files.eval("-d 0.5 -u m --pairs_from_reference").at("final").at("rpe").at("pairs_from") == "ground_truth");
  CHECK(files.eval("-d 5 -u d").at("final").at("rpe").at("delta_unit") == "degrees");
}

TEST_CASE("eval evaluates in a time range that may be open") {
  const Trajectories files;
  const Json json = files.eval("--t_start 1 --t_max_diff 0.001").at("final");
  CHECK(json.at("pairs") == 100);
  CHECK(json.at("association").at("time_range_s") == Json({1.0, nullptr}));
}

TEST_CASE("eval writes the structure of a run's metrics, which table reads") {
  const Trajectories files;
  const Json json = files.eval("-as");
  for (const char* key :
       {"experiment", "label", "final", "causal", "runtime_s", "realtime_factor", "peak_rss_mib", "status"}) {
    CHECK(json.contains(key));
  }
  for (const char* pointer : {"/ate/trans_m/rmse", "/ate/rot_deg/rmse", "/rpe/trans_m/rmse", "/rpe/rot_deg/sse",
                              "/coverage", "/pairs", "/scale", "/path_m", "/ate/trans_percent"}) {
    CHECK(json.at("final").at(Json::json_pointer(pointer)).is_number());
  }
  write_file(files.estimate, format_tum(read_tum(files.ground_truth)));
  files.folder.write("metrics.json", dump_json(json));
  CLI::App app;
  add_table(app);
  app.parse("table " + files.folder.path() + " --format csv --out " + files.folder.file("table.csv"));
  CHECK_THAT(read_file(files.folder.file("table.csv")),
             ContainsSubstring("experiment,label,seed,key,folder,ate.trans_m.rmse"));
  CHECK_THROWS_AS(app.parse("table " + files.folder.path() + " --metrics no.such"), InputError);
  CHECK_THROWS_AS(app.parse("table " + files.folder.path() + " --format html"), CLI::ParseError);
}

TEST_CASE("eval recognises RobotEvt ground truth by its columns") {
  const Trajectories files;
  const double before = files.eval("-as").at("final").at("ate").at("trans_m").at("rmse");
  write_file(files.ground_truth, format_robotevt(read_tum(files.ground_truth)));
  CHECK(files.eval("-as").at("final").at("ate").at("trans_m").at("rmse").get<double>() == Approx(before).epsilon(1e-6));
  CHECK_THROWS_AS(files.eval("--format tum"), InputError);
}

TEST_CASE("eval of several estimates prints a table and writes a list", "[slow]") {
  const Trajectories files;
  write_file(files.folder.file("perfect.txt"), read_file(files.ground_truth));
  const Outcome outcome = testing::evbench(files.folder, "eval truth.txt estimate.txt perfect.txt -as --json all.json");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("estimate.txt") && ContainsSubstring("perfect.txt") &&
                              ContainsSubstring("ATE [m]") && ContainsSubstring("Protocol: Sim(3) alignment") &&
                              !ContainsSubstring("Final:"));
  const Json list = parse_json(read_file(files.folder.file("all.json")));
  REQUIRE(list.size() == 2);
  CHECK(list[0].at("label") == "estimate.txt");
  CHECK(dump_json(list[0].at("final")) == dump_json(files.eval("-as").at("final")));
  CHECK(list[1].at("final").at("ate").at("trans_m").at("rmse").get<double>() < 1e-9);
  CHECK_THAT(testing::evbench(files.folder, "eval truth.txt estimate.txt --table latex").out,
             ContainsSubstring("\\toprule"));
  const Outcome missing = testing::evbench(files.folder, "eval truth.txt estimate.txt none.txt");
  CHECK(missing.exit_code == 2);
  CHECK_THAT(missing.err, ContainsSubstring("none.txt: no such file"));
}

TEST_CASE("eval takes errors over sub-trajectories as rpg_trajectory_evaluation and KITTI do", "[slow]") {
  const Trajectories files;
  CHECK_FALSE(files.eval("-as").at("final").contains("segments"));
  CHECK(files.eval("-as --segments rpg").at("final").at("segments").at("by_length").size() == 5);
  const Json kitti = files.eval("-as --segments kitti --segment_lengths 0.25,0.5").at("final").at("segments");
  CHECK(kitti.at("by_length")[1].at("length_m") == 0.5);
  CHECK(kitti.at("by_length")[1].at("trans_percent").at("n").get<int>() > 5);
  CHECK(files.eval("-as --segments kitti --segment_lengths 50 --segment_unit percent")
            .at("final")
            .at("segments")
            .at("unit") == "percent");
  CHECK(
      testing::evbench(files.folder, "eval --segments kitti --segment_lengths 0.5 truth.txt estimate.txt").exit_code ==
      0);
  CHECK_THROWS_AS(files.eval("--segments tum"), CLI::ParseError);
  CHECK_THROWS_AS(files.eval("--segment_lengths 1"), CLI::ParseError);
}

TEST_CASE("eval writes the aligned estimate and the error of each pose, and replaces files only by --force", "[slow]") {
  const Trajectories files;
  const std::string command = "eval truth.txt estimate.txt -as --aligned aligned.txt --errors errors.csv";
  REQUIRE(testing::evbench(files.folder, command).exit_code == 0);
  const PoseTrajectory truth = read_tum(files.ground_truth), aligned = read_tum(files.folder.file("aligned.txt"));
  REQUIRE(aligned.size() == truth.size());
  const Json scores = files.eval("-as").at("final");
  const std::string csv = read_file(files.folder.file("errors.csv"));
  CHECK(csv.starts_with("t_s,trans_m,rot_deg,x_m,y_m,z_m\n0,"));
  CHECK(std::ranges::count(csv, '\n') == 201);
  double sse = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sse += (aligned.poses()[i].T.p - truth.poses()[i].T.p).squaredNorm();
  }
  CHECK(sse == Approx(scores.at("ate").at("trans_m").at("sse").get<double>()).epsilon(1e-6));
  files.folder.write("errors.csv", "mine");
  std::filesystem::remove(files.folder.file("aligned.txt"));
  const Outcome again = testing::evbench(files.folder, command);
  CHECK(again.exit_code == 2);
  CHECK_THAT(again.err, ContainsSubstring("errors.csv: exists already; --force replaces it"));
  CHECK(read_file(files.folder.file("errors.csv")) == "mine");
  CHECK_FALSE(std::filesystem::exists(files.folder.file("aligned.txt")));
  CHECK(testing::evbench(files.folder, command + " --force").exit_code == 0);
  CHECK(read_file(files.folder.file("errors.csv")) == csv);
  CHECK(testing::evbench(files.folder, "eval truth.txt estimate.txt truth.txt --aligned a.txt").exit_code == 2);
}

TEST_CASE("table replaces a file only by --force", "[slow]") {
  const Trajectories files;
  files.folder.write("metrics.json", dump_json(files.eval("-as")));
  files.folder.write("table.txt", "mine");
  CHECK(testing::evbench(files.folder, "table . --out table.txt").exit_code == 2);
  CHECK(read_file(files.folder.file("table.txt")) == "mine");
  CHECK(testing::evbench(files.folder, "table . --out table.txt --force").exit_code == 0);
  CHECK_THAT(read_file(files.folder.file("table.txt")), ContainsSubstring("ATE [m]"));
}

TEST_CASE("eval reads pipes, and says what it waits for", "[slow]") {
  const Trajectories files;
  const std::string expected = testing::evbench(files.folder, "eval truth.txt estimate.txt -as --table csv").out;
  const Outcome piped = testing::shell(files.folder, R"(
    mkfifo pipe; { sleep 1.5; cat estimate.txt; } > pipe & "$evbench" eval truth.txt pipe -as --table csv)");
  CHECK(piped.exit_code == 0);
  CHECK(piped.out.substr(piped.out.find("pipe") + 4) == expected.substr(expected.find("estimate.txt") + 12));
  CHECK(piped.err == "pipe: nobody has written to it yet; waiting\n");
  CHECK(testing::shell(files.folder, "cat estimate.txt > pipe & \"$evbench\" eval truth.txt pipe").err.empty());
  CHECK(testing::shell(files.folder, "timeout -s INT 2 \"$evbench\" eval truth.txt pipe").exit_code == 124);
  const Outcome input =
      testing::shell(files.folder, "cat estimate.txt | \"$evbench\" eval truth.txt - -as --table csv");
  CHECK(input.exit_code == 0);
  CHECK(input.out.substr(input.out.find(",-,") + 2) == expected.substr(expected.find("estimate.txt") + 12));
}

TEST_CASE("eval gives the same scores for the same trajectories in KITTI's and EuRoC's layouts") {
  const Trajectories files;
  const auto ate = [&](const std::string& options) {
    const Json scores = files.eval("-as " + options).at("final");
    CHECK(scores.at("pairs") == 200);
    return scores.at("ate").at("trans_m").at("rmse").get<double>();
  };
  const double expected = ate("");
  const PoseTrajectory truth = read_tum(files.ground_truth), estimate = read_tum(files.estimate);
  const auto kitti = [](const PoseTrajectory& trajectory) {
    std::string text;
    for (const StampedPose& pose : trajectory.poses()) {
      const Matrix3 R = pose.T.R();
      for (Eigen::Index i = 0; i < 3; ++i) {
        text += fmt::format("{} {} {} {}{}", R(i, 0), R(i, 1), R(i, 2), pose.T.p[i], i < 2 ? " " : "\n");
      }
    }
    return text;
  };
  std::string times;
  for (const StampedPose& pose : truth.poses()) times += fmt::format("{}\n", pose.t);
  files.folder.write("times.txt", times);
  write_file(files.estimate, kitti(estimate));
  CHECK_THROWS_WITH(ate(""),
                    ContainsSubstring("estimate.txt: has no times, as the other trajectory has; expected --times"));
  CHECK(ate("--times " + files.folder.file("times.txt")) == Approx(expected).epsilon(1e-9));
  write_file(files.ground_truth, kitti(truth));
  CHECK(ate("") == Approx(expected).epsilon(1e-9));
  write_file(files.ground_truth, kitti(truth.cut(0.0, 1.0)));
  CHECK_THROWS_WITH(ate(""), ContainsSubstring("has 200 poses without times; expected 101"));

  std::string euroc = "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n";
  for (const auto& [t, T] : truth.poses()) {
    euroc += fmt::format("{:.0f},{},{},{},{},{},{},{}\n", 1e9 * t, T.p.x(), T.p.y(), T.p.z(), T.q.w(), T.q.x(), T.q.y(),
                         T.q.z());
  }
  write_file(files.ground_truth, euroc);
  CHECK(ate("--times " + files.folder.file("times.txt")) == Approx(expected).epsilon(1e-9));
  write_file(files.estimate, format_tum(estimate));
  CHECK(ate("") == Approx(expected).epsilon(1e-9));
}

TEST_CASE("eval reports how many poses of the estimate are unmatched", "[slow]") {
  const Trajectories files;
  write_file(files.ground_truth, format_tum(sample(wavy_pose, 20, 0.1)));
  const Outcome sparse = testing::evbench(files.folder, "eval truth.txt estimate.txt -as --json scores.json");
  CHECK(sparse.exit_code == 0);
  CHECK_THAT(sparse.out, ContainsSubstring("20 poses compared, 180 of the estimate unmatched"));
  CHECK_THAT(sparse.err, ContainsSubstring("estimate.txt: 180 of its 200 poses are not compared") &&
                             ContainsSubstring("--interpolate"));
  const Outcome all = testing::evbench(files.folder, "eval truth.txt truth.txt");
  CHECK(all.err.empty());
  CHECK_THAT(all.out, !ContainsSubstring("unmatched"));
}

TEST_CASE("eval determines an unknown unit of times by the other trajectory, or gives an error", "[slow]") {
  const Trajectories files;
  const auto in_unit = [](double per_second) {
    std::string text;
    for (const auto& [t, T] : sample(wavy_pose, 200, 0.01, 1.4e9).poses()) {
      text += fmt::format("{:.0f} {} {} {} {} {} {} {}\n", per_second * t, T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(),
                          T.q.z(), T.q.w());
    }
    return text;
  };
  write_file(files.ground_truth, format_tum(sample(wavy_pose, 200, 0.01, 1.4e9)));
  for (const auto& [count, unit] : {std::pair{1e3, "milliseconds"}, {1e6, "microseconds"}}) {
    write_file(files.estimate, in_unit(count));
    for (const char* command : {"eval truth.txt estimate.txt", "eval estimate.txt truth.txt"}) {
      const Outcome outcome = testing::evbench(files.folder, command);
      CHECK(outcome.exit_code == 0);
      CHECK_THAT(outcome.err, ContainsSubstring(fmt::format("estimate.txt: read with times in {}", unit)));
      CHECK_THAT(outcome.out, ContainsSubstring("200 poses compared"));
    }
    CHECK_THROWS_WITH(files.eval("--t_offset 1000"),
                      ContainsSubstring("estimate.txt:1: the time is") && ContainsSubstring("give --estimate_unit"));
  }
  write_file(files.ground_truth, in_unit(1e6));
  CHECK_THROWS_WITH(files.eval(""), ContainsSubstring("--estimate_unit and --groundtruth_unit"));
}

TEST_CASE("eval reports that another order of the quaternions fits, and how to choose it", "[slow]") {
  const Trajectories files;
  std::string w_first;
  for (const auto& [t, T] : sample(wavy_pose, 200, 0.05).poses()) {
    w_first +=
        fmt::format("{},{},{},{},{},{},{},{}\n", t, T.p.x(), T.p.y(), T.p.z(), T.q.w(), T.q.x(), T.q.y(), T.q.z());
  }
  write_file(files.ground_truth, format_tum(sample(wavy_pose, 200, 0.05)));
  write_file(files.estimate, w_first);
  const Outcome assumed = testing::evbench(files.folder, "eval truth.txt estimate.txt -a");
  CHECK_THAT(assumed.err, ContainsSubstring("columns t px py pz qx qy qz qw (assumed)") &&
                              ContainsSubstring("its quaternions seem to be in the order wxyz") &&
                              ContainsSubstring("give --estimate_quaternion wxyz"));
  const Outcome chosen = testing::evbench(files.folder, "eval truth.txt estimate.txt -a --estimate_quaternion wxyz");
  CHECK_THAT(chosen.err, !ContainsSubstring("seem to be"));
  CHECK(files.eval("-a --estimate_quaternion wxyz").at("final").at("ate").at("rot_deg").at("rmse").get<double>() <
        1e-6);
  // The ground truth's is the one of which less is known.
  CHECK_THAT(testing::evbench(files.folder, "eval estimate.txt truth.txt -a").err,
             ContainsSubstring("estimate.txt: its quaternions seem") &&
                 ContainsSubstring("give --groundtruth_quaternion wxyz"));
  CHECK_THROWS_AS(files.eval("--estimate_quaternion abcd"), CLI::ParseError);
}

TEST_CASE("eval reads other tools' files in their own conventions") {
  const struct {
    const char *truth, *estimate, *options, *score;
    double expected, error;
  } cases[] = {
      {"cases/columns/groundtruth.txt", "cases/columns/rostopic_late.csv", "-a", "/ate/trans_m/rmse", 0.0168, 1e-4},
      {"cases/vins/groundtruth.csv", "cases/vins/vins_result_no_loop.csv", "-a", "/ate/rot_deg/rmse", 0.0363, 1e-4},
      {"cases/vins/groundtruth.csv", "cases/vins/vins_result_no_loop.csv", "-a", "/rpe/trans_m/rmse", 0.0224, 1e-4},
      {"trajectories/deio_poster_translation/groundtruth.txt", "trajectories/deio_poster_translation/estimate.txt",
       "-as --t_offset -1468940220.331 --estimate_quaternion yzwx", "/ate/rot_deg/rmse", 1.082, 1e-3}};
  for (const auto& [truth, estimate, options, score, expected, error] : cases) {
    const auto truth_path = data_file(truth), estimate_path = data_file(estimate);
    if (!truth_path || !estimate_path) return;
    CAPTURE(estimate, score);
    const TemporaryFolder folder;
    CLI::App app;
    add_eval(app);
    app.parse(fmt::format("eval {} {} {} --json {}", *truth_path, *estimate_path, options, folder.file("s.json")));
    const Json scores = parse_json(read_file(folder.file("s.json"))).at("final");
    CHECK(scores.at(Json::json_pointer(score)).get<double>() == Approx(expected).margin(error));
  }
}

TEST_CASE("eval gives an error for what it can't score and then writes nothing") {
  const Trajectories files;
  CHECK_THROWS_AS(files.eval("--t_offset 100"), InputError);
  files.folder.write("estimate.txt", "1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n");
  CHECK_THROWS_WITH(files.eval(""), ContainsSubstring("estimate.txt"));
  for (const char* options : {"-d 0", "--t_offset nan", "--t_start nan", "--t_end inf", "--align_range 0 nan -a",
                              "-a --n_to_align 0", "-a --n_to_align -2"}) {
    CAPTURE(options);
    CHECK_THROWS_AS(files.eval(options), CLI::ParseError);
  }
  CHECK_FALSE(std::filesystem::exists(files.json));
}

}  // namespace evbench
