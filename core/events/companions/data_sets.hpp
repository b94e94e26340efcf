#pragma once

#include <memory>
#include <string>

#include "core/events/companions/companions.hpp"

// The data sets' own calibrations and ground truths: a function and a file each, listed in companions.cpp.
namespace evbench {

/// Where events are, and whose.
struct EventsPlace {
  std::shared_ptr<const RecordingFiles> files;
  std::string path;    ///< of the events; empty: a folder without
  bool right = false;  ///< camera of a stereo pair; otherwise the left one

  /// The file's name without this end; "" when it ends otherwise.
  std::string name_before(const std::string& end) const;
};

/// The file beside the events that has their name with another end, e.g. a_gt.hdf5 of a_data.hdf5; where the events'
/// name does not end so (a native copy), the only one with that end. "" when there is none.
std::string partner(const EventsPlace& place, const std::string& end, const std::string& partners_end);

/// The only one of several files of a kind, of which a sequence has one. Throws InputError that names them all.
std::string only(const RecordingFiles& files, const std::vector<std::string>& names);

/// calib.txt (fx fy cx cy k1 k2 p1 p2 k3) and groundtruth.txt (TUM), both of the camera. Mueggler et al., IJRR 2017.
Companions ecd_companions(const EventsPlace& place);

/// cam_to_cam.yaml, intrinsics.cam0 (left) or cam3 (right); there are no poses. Gehrig et al., RA-L 2021.
Companions dsec_companions(const EventsPlace& place);

/// camera-calibration[AB].json as Basalt writes it: cameras 2 (left) and 3 (right) with kb4 lenses and T_imu_cam;
/// mocap_data.txt: T_world_marker, times in µs; mocap-imu-calibration[AB].json: T_imu_marker. The truth is
/// T_world_camera = T_world_marker T_imu_marker⁻¹ T_imu_cam where all are there, T_world_marker elsewhere.
/// Klenk et al., IROS 2021.
Companions tumvie_companions(const EventsPlace& place);

/// NAME_pose_gt.h5: Cn_T_C0, of the left event camera, at ts [µs]; T_world_camera = Cn_T_C0⁻¹, for the right one
/// followed by its calib/T_to_prophesee_left in NAME_data.h5, where that is there. The calibration is in it, too.
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
