#include "core/events/companions/hdf5_poses.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/data/calibration_fields.hpp"
#include "core/events/hdf5/file.hpp"
#include "core/events/hdf5/trial.hpp"
#include "core/support/error.hpp"

namespace evbench::hdf5 {
namespace {

std::vector<double> read_numbers(const File& file, const std::string& name) {
  if (!file.has_dataset(name)) throw InputError(fmt::format("{}: /{}: is missing; expected poses", file.path(), name));
  return file.dataset(name).read_all();
}

}  // namespace

std::vector<StampedPose> read_poses(const std::string& path, const std::string& matrices, const std::string& times,
                                    double unit) {
  try_datasets(path, {matrices, times});
  const File file(path);
  const std::vector<double> T = read_numbers(file, matrices), t = read_numbers(file, times);
  if (t.empty() || T.size() != 16 * t.size()) {
    throw InputError(fmt::format("{}: /{}: has {} numbers for {} times; expected a 4x4 matrix for each", path, matrices,
                                 T.size(), t.size()));
  }
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) throw InputError(fmt::format("{}: /{}: row {}: is no time", path, times, i));
    poses.push_back({unit * t[i], checked_pose(fmt::format("{}: /{}: row {}", path, matrices, i), &T[16 * i])});
  }
  return poses;
}

SE3 read_pose(const std::string& path, const std::string& matrix) {
  try_datasets(path, {matrix});
  const std::vector<double> T = read_numbers(File(path), matrix);
  if (T.size() != 16) {
    throw InputError(fmt::format("{}: /{}: has {} numbers; expected a 4x4 matrix", path, matrix, T.size()));
  }
  return checked_pose(fmt::format("{}: /{}", path, matrix), T.data());
}

}  // namespace evbench::hdf5
