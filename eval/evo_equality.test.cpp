#include <fstream>

#include "core/data/tum.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/scores.hpp"

namespace evbench {
namespace {

ScoreOptions options_of(const std::string& alignment) {
  ScoreOptions options;
  options.alignment = alignment == "scale_only" ? "scale" : alignment;
  return options;
}

/// "rpe_10frames_all_trans_m" → delta 10, frames, all.
void set_relative(ScoreOptions& options, const std::string& key) {
  std::size_t used = 0;
  const std::string text = key.substr(4);
  options.rpe_delta = std::stod(text, &used);
  options.rpe_unit = text.substr(used, 6) == "frames" ? "frames" : "metres";
  options.rpe_pairing = text.find("_all_") != std::string::npos ? "all" : "consecutive";
}

/// Values compared; each must agree to 1e-6 of its size.
int compare(const Statistics& ours, const Json& theirs) {
  int compared = 0;
  const Json json = to_json(ours);
  for (const auto& [name, value] : theirs.items()) {
    INFO(name);
    CHECK(json.at(name).get<double>() == Approx(value.get<double>()).epsilon(1e-6).margin(0.0));
    ++compared;
  }
  return compared;
}

}  // namespace

TEST_CASE("Scores equal every value that evo computes") {
  const std::string sequence = GENERATE("mvsec_flying1", "tumvie_desk2", "tumvie_mocap-6dof");
  const auto expected_path = testing::data_file("trajectories/" + sequence + "/expected_evo.json");
  const auto truth_path = testing::data_file("trajectories/" + sequence + "/groundtruth.txt");
  const auto estimate_path = testing::data_file("trajectories/" + sequence + "/estimate.txt");
  if (!expected_path || !truth_path || !estimate_path) return;
  INFO(sequence);
  const PoseTrajectory ground_truth = read_tum(*truth_path);
  const PoseTrajectory estimate = read_tum(*estimate_path);
  const Json expected = parse_json(testing::read_file(*expected_path));

  int compared = 0;
  for (const std::string alignment : {"none", "se3", "sim3", "scale_only"}) {
    for (const auto& [key, value] : expected.at(alignment).items()) {
      INFO(alignment << " " << key);
      ScoreOptions options = options_of(alignment);
      if (key.starts_with("rpe_")) set_relative(options, key);
      const Scores scores = score(ground_truth, estimate, options);
      CHECK(scores.pairs == expected.at("pairs").get<std::size_t>());
      CHECK(scores.path_m == Approx(expected.at("gt_length_m").get<double>()).epsilon(1e-6));
      if (key == "scale") {
        CHECK(scores.alignment.transform.scale == Approx(value.get<double>()).epsilon(1e-6));
        ++compared;
      } else if (key.starts_with("rpe_")) {
        compared += compare(key.ends_with("_trans_m") ? scores.rpe.trans_m : scores.rpe.rot_deg, value);
      } else {
        compared += compare(key == "ape_trans_m" ? scores.ate.trans_m : scores.ate.rot_deg, value);
      }
    }
  }
  // Per alignment: 7 statistics of two absolute errors, 8 of ten relative ones, and the scale (not of "none").
  CHECK(compared == 4 * (2 * 7 + 10 * 8) + 3);
}

}  // namespace evbench
