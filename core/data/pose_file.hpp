#pragma once

#include <string>
#include <vector>

#include "core/data/time_unit.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// The layouts that have a name. automatic: by the names of the columns where the file has them (the comment before the
/// first record, or a line of names), otherwise by their number and whether rotations are rotations.
enum class PoseFormat { automatic, tum, euroc, kitti, robotevt };

inline constexpr std::array kPoseFormatNames{"auto", "tum", "euroc", "kitti", "robotevt"};

/// The order of a quaternion's columns. zwxy and yzwx are what is left when one of the usual orders was taken for the
/// other. Each is the one before it, moved one column to the right. automatic: by names, or the layout's.
enum class QuaternionOrder { automatic, xyzw, wxyz, zwxy, yzwx };

inline constexpr std::array kQuaternionOrderNames{"auto", "xyzw", "wxyz", "zwxy", "yzwx"};

struct PoseFileOptions {
  PoseFormat format = PoseFormat::automatic;
  QuaternionOrder quaternion = QuaternionOrder::automatic;  ///< whatever names or layout say
  TimeUnit time_unit = TimeUnit::unsaid;
  std::string times = {};      ///< path of a file with a time a line, for poses without; empty: none
  bool may_number = false;     ///< poses without times get their numbers 0, 1, ... as times; otherwise they are refused
  bool may_lack_unit = false;  ///< times whose unit nothing tells are given as they stand; otherwise they are refused
};

struct PoseFile {
  PoseTrajectory trajectory;
  std::vector<std::string> remarks;  ///< sentences: what was assumed, or left out
  bool numbered = false;             ///< times are numbers of poses
  std::string unknown_unit = {};     ///< why the unit of the times is not known: they are as they stand; empty: seconds
  QuaternionOrder quaternion = QuaternionOrder::automatic;  ///< as it was read; automatic: none of the others
  bool quaternion_is_assumed = false;                       ///< neither names nor the options tell its order
};

/// Reads a trajectory, T_world_camera, a pose a line in columns between blanks, tabs, commas or semicolons:
///
///   tum       t px py pz qx qy qz qw, further columns are not read. The Event-Camera Dataset's groundtruth.txt.
///   euroc     t px py pz qw qx qy qz, likewise; known by its names, by 17 columns, or by commas and nanoseconds since
///             1970, as VINS writes it
///   kitti     r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz, also with the row 0 0 0 1 behind, or with t before
///   robotevt  t r11 r12 r13 r21 ... r33 px py pz
///
/// or in any order that names tell: "field.header.stamp" goes before the other times of `rostopic echo -p`, "sec" and
/// "nsec" are one. Hamilton quaternions, metres; times in seconds unless the options, the column's
/// name (t_us, "timestamp [ns]") or their size tells another unit (usual_time_unit()). Poses with the time of the one
/// before them are left out. Throws InputError, naming file and line, for another number of columns, names of which
/// two fit (of two bodies), a value that is not finite, a quaternion whose norm is not within 1e-2 of 1 (it is
/// normalised), a matrix that is not a rotation to 1e-2 (the nearest one is taken), times that decrease, times that are
/// missing, and a file without poses.
PoseFile read_poses(const std::string& path, const PoseFileOptions& options = {});

/// For times whose unit is unknown: as in seconds from now on. Poses whose times are equal then are left out.
void set_time_unit(PoseFile& file, TimeUnit unit);

}  // namespace evbench
