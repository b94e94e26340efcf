#include <cmath>

#include "bench/published.hpp"
#include "bench/reference.hpp"
#include "bench/testing/configs.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/find_runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Compares `evbench eval` by every protocol with eval/testing/protocols.py, an independent transcription in numpy.
void check_protocols(const std::string& truth, const std::string& estimate, const std::string& options = "") {
  const TemporaryFolder folder;
  const Outcome outcome =
      shell(folder, "/usr/bin/python3 '" + std::string(EVBENCH_READERS) + "/../protocols.py' \"$evbench\" '" + truth +
                        "' '" + estimate + "' " + options);
  CAPTURE(outcome.out, outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("10 protocols, 0 differences"));
}

constexpr const char* kDeio = "--estimate_quaternion yzwx --estimate_unit us --t_offset -1468940220.3255";

/// A helix in 20 s at 50 Hz, faster and slower, at another scale and place.
std::string helix(double scale, double shift) {
  std::string text;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.02 * i, a = 0.3 * t + 0.2 * std::sin(1.3 * t);
    text += fmt::format("{} {} {} {} 0 0 {} {}\n", t, scale * 3.0 * std::cos(a) + shift, scale * 3.0 * std::sin(a),
                        scale * 0.1 * t, std::sin(0.5 * a), std::cos(0.5 * a));
  }
  return text;
}

}  // namespace

TEST_CASE("Each protocol has the numbers of an independent transcription to 1e-9, on released trajectories") {
  for (const std::string name : {"mvsec_flying1", "tumvie_desk2", "tumvie_mocap-6dof", "deio_poster_translation"}) {
    const auto truth = data_file("trajectories/" + name + "/groundtruth.txt");
    if (!truth) return;
    INFO(name);
    check_protocols(*truth, *data_file("trajectories/" + name + "/estimate.txt"),
                    name == "deio_poster_translation" ? kDeio : "");
  }
}

TEST_CASE("A trajectory that DEIO released has its published size of error by its protocol, others by others") {
  const auto truth = data_file("trajectories/deio_poster_translation/groundtruth.txt");
  if (!truth) return;
  const TemporaryFolder folder;
  const auto scores = [&](const std::string& protocol) {
    const Outcome outcome = shell(folder, "\"$evbench\" eval '" + *truth + "' '" +
                                              *data_file("trajectories/deio_poster_translation/estimate.txt") + "' " +
                                              kDeio + " --force --json scores.json --protocol " + protocol);
    REQUIRE(outcome.exit_code == 0);
    return parse_json(read_file(folder.file("scores.json"))).at("final");
  };
  const auto check = [](const Json& of, double centimetres, double percent) {
    CHECK(100.0 * of.at("ate").at("trans_m").at("rmse").get<double>() == Approx(centimetres).margin(0.011));
    CHECK(of.at("mpe_percent").get<double>() == Approx(percent).margin(0.0006));
  };
  check(scores("deio"), 1.79, 0.029);
  check(scores("esvo"), 1.83, 0.030);  // SE(3) on all poses
  check(scores("hku_5s"), 2.98, 0.053);
}

TEST_CASE("The time offset that fits best is found to 0.1 ms, and named") {
  const TemporaryFolder folder;
  folder.write("truth.txt", helix(1.0, 0.0));
  folder.write("estimate.txt", helix(0.5, 1.0));
  const Outcome outcome =
      shell(folder, "\"$evbench\" eval truth.txt estimate.txt -as --t_max_diff 0.1 --t_offset 0.0432 --fit_offset 0.1");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, ContainsSubstring("0.0000 s are added to its times"));
  const Outcome far =
      shell(folder, "\"$evbench\" eval truth.txt estimate.txt -as --t_max_diff 0.1 --t_offset 0.3 --fit_offset 0.1");
  CHECK_THAT(far.err, ContainsSubstring("0.2000 s are added") && ContainsSubstring("within --fit_offset"));
  const Outcome wide = shell(folder, "\"$evbench\" eval truth.txt estimate.txt -as --t_max_diff 0.1 --fit_offset 19.9");
  CHECK_THAT(wide.err, ContainsSubstring("0.0000 s are added"));  // not two poses that overlap
}

TEST_CASE("A protocol comes from a config, an option or a table, and a setting beside it makes it custom") {
  const TemporaryFolder folder;
  folder.write("truth.txt", helix(1.0, 0.0));
  folder.write("estimate.txt", helix(0.5, 1.0));
  const auto eval = [&](const std::string& options) {
    return shell(folder, "\"$evbench\" eval truth.txt estimate.txt " + options);
  };
  CHECK_THAT(eval("--protocol devo").out,
             ContainsSubstring("protocol     devo") && ContainsSubstring("scale        2.000000"));
  CHECK_THAT(eval("--protocol devo --t_end 10").out, ContainsSubstring("only up to 10 s"));
  for (const char* beside : {"-a", "--t_max_diff 0.1", "--n_to_align 100", "--interpolate", "-d 2", "--segments rpg"}) {
    const Outcome outcome = eval(std::string("--protocol devo ") + beside);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring("excludes --protocol"));
  }
  CHECK_THAT(eval("--protocol devi").err, ContainsSubstring("devo"));

  const std::string run = "\"$evbench\" run '" + std::string(EVBENCH_CONFIGS) +
                          "/examples/simulated_tracks.json' --quiet --out results "
                          "--set evaluation='{\"protocol\": \"deio\"}' --set source.duration=3 ";
  REQUIRE(shell(folder, run).exit_code == 0);
  const auto table = [&](const std::string& options) {
    return shell(folder, "\"$evbench\" table results " + options).out;
  };
  CHECK_THAT(table(""), ContainsSubstring("Protocol: deio: Sim(3) alignment on the first 1000 poses"));
  CHECK_THAT(table("--protocol hku_5s"), ContainsSubstring("Protocol: hku_5s: SE(3) alignment on the poses 0 to 5 s"));
  CHECK_THAT(table(""), ContainsSubstring("Protocol: deio"));  // the run is unchanged
  REQUIRE(shell(folder, "\"$evbench\" score results --set evaluation.tolerance=0.02").exit_code == 0);
  CHECK_THAT(table(""), ContainsSubstring("Protocol: custom (deio but tolerance): "));
  CHECK(shell(folder, "\"$evbench\" score results --protocol evo --set evaluation.tolerance=1").exit_code == 2);
  REQUIRE(shell(folder, "\"$evbench\" score results --set evaluation.protocol=tum").exit_code == 0);
  CHECK_THAT(table(""), ContainsSubstring("Protocol: tum: SE(3) alignment on all poses"));
  REQUIRE(shell(folder, "\"$evbench\" score results --protocol evo").exit_code == 0);
  CHECK_THAT(table(""), ContainsSubstring("Protocol: evo: no alignment; nearest ground truth within 0.01 s"));
}

TEST_CASE("Runs stand beside published numbers of their sequence, each by its own protocol, and no others") {
  if (!data_file("poster_translation/tracks_eklt.txt")) return;
  const TemporaryFolder folder;
  REQUIRE(shell(folder, "\"$evbench\" run '" + std::string(EVBENCH_CONFIGS) +
                            "/paper/table1_poster_translation.json' --quiet --out results --set "
                            "'backends=[{\"type\":\"bundle_adjustment\",\"batch_duration\":0.1}]'")
              .exit_code == 0);
  const auto table = [&](const std::string& options) {
    return shell(folder, "root=\"$PWD\" && cd '" + std::string(EVBENCH_CONFIGS) +
                             "/..' && \"$evbench\" table \"$root/results\" --published " + options);
  };
  const Outcome published = table("poster_translation --format csv");
  CAPTURE(published.err);
  CHECK_THAT(published.out, ContainsSubstring("deio,DEIO,\"events, IMU; learned, GPU\",0.04"));
  for (const char* protocol : {"eklt_vio", "hku_5s", "devo", "deio"}) {
    CHECK_THAT(published.out, ContainsSubstring(std::string(protocol) + ",bundle_adjustment,recorded tracks,"));
  }
  CHECK_THAT(table("poster_7dof").err, ContainsSubstring("poster_6dof"));
  CHECK_THAT(table("hdr_poster").err, ContainsSubstring("none of these runs is of hdr_poster"));
  CHECK_THAT(table("poster_translation --protocol evo").err, ContainsSubstring("excludes"));
}

TEST_CASE("Runs are compared with results that were written before") {
  const TemporaryFolder folder;
  REQUIRE(shell(folder, "\"$evbench\" run '" + std::string(EVBENCH_CONFIGS) +
                            "/examples/simulated_tracks.json' --quiet --out results && \"$evbench\" table results "
                            "--format csv --out before.csv")
              .exit_code == 0);
  const std::vector<RunRecord> runs = find_runs(std::vector{folder.file("results")}, nullptr);
  const std::string same = compare_with_reference(runs, folder.file("before.csv"));
  CHECK_THAT(same, ContainsSubstring("1 of 1 runs") && ContainsSubstring("ATE [m]: within 0 %"));
  std::string text = read_file(folder.file("before.csv"));
  const double ate = runs[0].final_scores.at("ate").at("trans_m").at("rmse").get<double>();
  const std::string digits = fmt::format("{}", ate);
  REQUIRE(text.find(digits) != std::string::npos);
  folder.write("other.csv", text.replace(text.find(digits), digits.size(), fmt::format("{}", 0.8 * ate)));
  CHECK_THAT(compare_with_reference(runs, folder.file("other.csv")),
             ContainsSubstring("ATE [m]: within 25 % (bundle_adjustment, seed 1)"));
  folder.write("none.csv", "a,b\n1,2\n");
  CHECK_THROWS_WITH(compare_with_reference(runs, folder.file("none.csv")), ContainsSubstring("none.csv"));
}
