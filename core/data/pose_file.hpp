#pragma once

#include <string>
#include <vector>

#include "core/data/time_unit.hpp"
#include "core/motion/body_velocities.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// Layout of a pose file. automatic: from the column names if the file has them (in the comment before the first record
/// or a line of names), otherwise from the number of columns and the validity of the rotations.
enum class PoseFormat { automatic, tum, euroc, kitti, robotevt };

inline constexpr std::array kPoseFormatNames{"auto", "tum", "euroc", "kitti", "robotevt"};

/// Order of a quaternion's columns. zwxy and yzwx result from mistaking one of the usual orders for the other; each
/// order is the previous one shifted by one column to the right. automatic: from the names or the layout.
enum class QuaternionOrder { automatic, xyzw, wxyz, zwxy, yzwx };

inline constexpr std::array kQuaternionOrderNames{"auto", "xyzw", "wxyz", "zwxy", "yzwx"};

struct PoseFileOptions {
  PoseFormat format = PoseFormat::automatic;
  QuaternionOrder quaternion = QuaternionOrder::automatic;  ///< overrides names and layout
  TimeUnit time_unit = TimeUnit::unsaid;
  std::string times = {};      ///< path of a file with one time per line, for poses without times; empty: none
  bool may_number = false;     ///< poses without times get the times 0, 1, ...; otherwise they are refused
  bool velocities = false;     ///< three further columns hold the linear velocity; otherwise none is read
  bool may_lack_unit = false;  ///< times of unknown unit are returned unchanged; otherwise they are refused
};

struct PoseFile {
  PoseTrajectory trajectory;
  BodyVelocities velocities = {};         ///< at its poses, if requested; without angular velocities, which are zero
  std::vector<std::string> remarks = {};  ///< sentences: assumptions and omissions
  bool numbered = false;                  ///< times are the numbers of the poses
  std::string unknown_unit = {};          ///< why the unit of the times is unknown (they are unchanged); empty: seconds
  QuaternionOrder quaternion = QuaternionOrder::automatic;  ///< as read; automatic: none of the others
  bool quaternion_is_assumed = false;                       ///< neither names nor options give its order
};

/// Reads a trajectory, T_world_camera, one pose per line in columns separated by blanks, tabs, commas or semicolons:
///
///   tum       t px py pz qx qy qz qw, further columns are not read. The Event-Camera Dataset's groundtruth.txt.
///   euroc     t px py pz qw qx qy qz, likewise; recognised by its names, by 17 columns, or by commas and nanoseconds
///             since 1970, as VINS writes it
///             With the option `velocities` either is followed by vx vy vz [m/s] and nothing else.
///   kitti     r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz, optionally followed by the row 0 0 0 1 or preceded by t
///   robotevt  t r11 r12 r13 r21 ... r33 px py pz
///
/// or in any order that column names give: "field.header.stamp" is preferred to the other times of `rostopic echo -p`;
/// "sec" and "nsec" form one time. Hamilton quaternions, metres. Times are seconds unless the options, the column name
/// (t_us, "timestamp [ns]") or their size give another unit (usual_time_unit()). Poses with the time of the previous
/// pose are dropped. Quaternions are normalised, matrices replaced by the nearest rotation. Throws InputError with file
/// and line for a wrong number of columns, ambiguous names (two bodies), a value that is not finite, a quaternion whose
/// norm is not within 1e-2 of 1, a matrix that is not a rotation to 1e-2, decreasing or missing times, and a file
/// without poses.
PoseFile read_poses(const std::string& path, const PoseFileOptions& options = {});

/// Converts times of unknown unit from `unit` to seconds. Poses whose times become equal are dropped.
void set_time_unit(PoseFile& file, TimeUnit unit);

}  // namespace evbench
