#pragma once

#include <string>

#include "eval/names.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// Kind of error: absolute or relative, translation [m] or rotation angle [deg].
enum class EvoError { ape_trans, ape_rot, rpe_trans, rpe_rot };
inline constexpr NameList<4> kEvoErrorNames = {"ape_trans", "ape_rot", "rpe_trans", "rpe_rot"};

/// A result archive (.zip) in the format of evo 1 (evo_ape --save_results, file_interface.save_res_file), for evo_res
/// and its plots: info.json (title, label, ref_name, est_name), stats.json (rmse, mean, median, std, min, max, sse),
/// error_array.npy; timestamps.npy, seconds_from_start.npy and distances_from_start.npy of the pose of each error (the
/// second one of a relative error); and alignment_transformation_sim3.npy. `estimate`: the name that evo shows.
std::string evo_result(const Scores& scores, EvoError error, const std::string& estimate);

}  // namespace evbench
