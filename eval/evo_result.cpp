#include "eval/evo_result.hpp"

#include <bit>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "core/io/zip.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");

/// numpy's format 1.0: 64-bit floats, row by row.
std::string npy(std::span<const double> values, const std::string& shape) {
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape);
  constexpr std::size_t kPrefix = 10, kAlignment = 64;  // [bytes] magic, version, length
  header.append(kAlignment - 1 - (kPrefix + header.size()) % kAlignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return bytes;
}

std::string npy(const std::vector<double>& values) { return npy(values, fmt::format("({},)", values.size())); }

std::string npy(const Similarity& transform) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = transform.scale * transform.T.q.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = transform.T.p;
  return npy({matrix.data(), 16}, "(4, 4)");
}

/// The poses that errors belong to, by index.
std::vector<std::size_t> places(const Scores& scores, bool relative) {
  std::vector<std::size_t> result;
  if (relative) {
    for (const auto& [first, second] : delta_pairs(scores.compared, relative_options(scores.options))) {
      result.push_back(second);
    }
  } else {
    for (std::size_t i = 0; i < scores.compared.size(); ++i) result.push_back(i);
  }
  return result;
}

std::vector<double> errors_of(const Scores& scores, bool relative, bool rotation) {
  const std::span<const PosePair> pairs = scores.compared;
  PoseErrors errors =
      relative ? relative_errors(pairs, delta_pairs(pairs, relative_options(scores.options))) : absolute_errors(pairs);
  return rotation ? std::move(errors.rot_deg) : std::move(errors.trans_m);
}

Json info(const Scores& scores, bool relative, bool rotation, const std::string& estimate) {
  const char* name = relative ? "RPE" : "APE";
  const char* unit = rotation ? "deg" : "m";
  const char* part = rotation ? "rotation angle in degrees (deg)" : "translation part (m)";
  std::string title = fmt::format("{} w.r.t. {}\n", name, part);
  if (relative) title += fmt::format("for delta = {} ({})\n", scores.options.rpe_delta, scores.options.rpe_unit);
  title += fmt::format("(alignment: {})", scores.options.alignment);
  return {{"title", title},
          {"label", fmt::format("{} ({})", name, unit)},
          {"ref_name", "groundtruth.tum"},
          {"est_name", estimate}};
}

}  // namespace

std::string evo_result(const Scores& scores, EvoError error, const std::string& estimate) {
  const bool relative = error == EvoError::rpe_trans || error == EvoError::rpe_rot;
  const bool rotation = error == EvoError::ape_rot || error == EvoError::rpe_rot;
  const std::vector<double> errors = errors_of(scores, relative, rotation);
  std::vector<double> lengths = {0.0};  // of the ground truth's path up to each pose
  for (std::size_t i = 1; i < scores.compared.size(); ++i) {
    const Vector3 step = scores.compared[i].ground_truth.p - scores.compared[i - 1].ground_truth.p;
    lengths.push_back(lengths.back() + step.norm());
  }
  std::vector<double> times, seconds, distances;
  for (const std::size_t i : places(scores, relative)) {
    times.push_back(scores.compared[i].t);
    seconds.push_back(scores.compared[i].t - scores.compared.front().t);
    distances.push_back(lengths[i]);
  }
  Json stats = to_json(statistics(errors));
  stats.erase("n");
  const std::vector<std::pair<std::string, std::string>> files = {
      {"info.json", dump_json(info(scores, relative, rotation, estimate))},
      {"stats.json", dump_json(stats)},
      {"error_array.npy", npy(errors)},
      {"timestamps.npy", npy(times)},
      {"seconds_from_start.npy", npy(seconds)},
      {"distances_from_start.npy", npy(distances)},
      {"alignment_transformation_sim3.npy", npy(scores.alignment.transform)}};
  return zip(files);
}

}  // namespace evbench
