#pragma once

#include <memory>
#include <string>

#include "core/events/companions/companions.hpp"

// Calibration and ground truth of the public data sets: one function and one file each, listed in companions.cpp.
namespace evbench {

/// Where the events are, and of which camera.
struct EventsPlace {
  std::shared_ptr<const RecordingFiles> files;
  std::string path;    ///< of the events; empty: a folder without events
  bool right = false;  ///< camera of a stereo pair; otherwise the left one

  /// The file's name without the suffix `end`; "" when it has another one.
  std::string name_before(const std::string& end) const;
};

/// The file next to the events with their name and another suffix, e.g. a_gt.hdf5 of a_data.hdf5. If the events' name
/// does not end in `end` (a native copy), the only file with that suffix. "" when there is none.
std::string partner(const EventsPlace& place, const std::string& end, const std::string& partners_end);

/// The only file of a kind that a sequence has once. Throws InputError, naming all files, when there are several.
std::string only(const RecordingFiles& files, const std::vector<std::string>& names);

/// calib.txt (fx fy cx cy k1 k2 p1 p2 k3) and groundtruth.txt (TUM), both of the camera. Mueggler et al., IJRR 2017.
Companions ecd_companions(const EventsPlace& place);

/// cam_to_cam.yaml, intrinsics.cam0 (left) or cam3 (right); there are no poses. Gehrig et al., RA-L 2021.
Companions dsec_companions(const EventsPlace& place);

/// camera-calibration[AB].json as Basalt writes it: cameras 2 (left) and 3 (right) with kb4 lenses and T_imu_cam;
/// mocap_data.txt: T_world_marker, times in µs; mocap-imu-calibration[AB].json: T_imu_marker. The ground truth is
/// T_world_camera = T_world_marker T_imu_marker⁻¹ T_imu_cam if all files exist, otherwise T_world_marker.
/// Klenk et al., IROS 2021.
Companions tumvie_companions(const EventsPlace& place);

/// NAME_pose_gt.h5: Cn_T_C0, of the left event camera, at ts [µs]; T_world_camera = Cn_T_C0⁻¹. For the right camera
/// this is followed by its calib/T_to_prophesee_left in NAME_data.h5, if that exists. NAME_data.h5 has the calibration,
/// too.
/// Chaney et al., CVPRW 2023.
Companions m3ed_companions(const EventsPlace& place);

/// NAME_gt.hdf5: davis/left/pose, T_world_camera at davis/left/pose_ts [s]; camchain-imucam-*.yaml of Kalibr, of
/// several the one whose name NAME begins with: cam0 (left), cam1 (right), whose T_cn_cnm1 gives the right camera's
/// poses. Zhu et al., RA-L 2018.
Companions mvsec_companions(const EventsPlace& place);

/// stamped_groundtruth.txt (TUM), of the event camera (the authors have applied their hand-eye calibration); a
/// camchain*.yaml of Kalibr: cam1. Hidalgo-Carrió et al., CVPR 2022.
Companions eds_companions(const EventsPlace& place);

}  // namespace evbench
