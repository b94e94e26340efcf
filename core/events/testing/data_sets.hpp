#pragma once

#include <cstdlib>
#include <string>

#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

namespace evbench::testing {

/// Small recordings as `evbench dataset get` leaves those of public data sets, written by Python's h5py and as text in
/// folders below `folder`: dsec/seq, dsec/nested, tumvie/mocap-desk, m3ed/falcon, mvsec/flying1, eds/peanuts. Each has
/// 100 events, 1 ms apart. Without h5py it warns and returns false.
inline bool write_data_sets(const TemporaryFolder& folder) {
  const char* const script = R"PY(
import os, sys, h5py, numpy as np
os.chdir(sys.argv[1])
i = np.arange(100)

def text(path, content):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w') as f: f.write(content)

def columns(group, start):
    group['x'] = (i % 600).astype(np.uint16)
    group['y'] = (i % 200).astype(np.uint16)
    group['t'] = start + 1000 * i
    group['p'] = (i % 2).astype(np.uint8)

def camera(key, fx, intrinsics='intrinsics', lens='radtan', size='[640, 480]', more=''):
    return (f'  {key}:\n    camera_model: pinhole\n    distortion_coeffs: [-0.1, 0.2, 0.003, -0.004]\n'
            f'    distortion_model: {lens}\n    {intrinsics}: [{fx}, {fx + 1}, 320.5, 240.25]\n'
            f'    resolution: {size}\n{more}')

def kalibr(first, second, **options):
    more = '    T_cn_cnm1:\n    - [1, 0, 0, -0.1]\n    - [0, 1, 0, 0]\n    - [0, 0, 1, 0]\n    - [0, 0, 0, 1]\n'
    lines = camera('cam0', first, **options) + camera('cam1', second, more=more, **options)
    return '\n'.join(line[2:] for line in lines.split('\n'))

def h5(path):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    return h5py.File(path, 'w')

for place in ('dsec/seq/', 'dsec/nested/events/left/', 'dsec/nested/events/right/'):
    with h5(place + 'events.h5') as f:
        columns(f.create_group('events'), 0)
        f['t_offset'] = 50_000_000_000
        f['ms_to_idx'] = i.astype(np.uint64)
    with h5(place + 'rectify_map.h5') as f:
        f['rectify_map'] = np.zeros((4, 4, 2), np.float32)
yaml = ('%YAML 1.1\n---\nextrinsics:\n  T_10:\n  - [1.0, 0.0, 0.0, 0.0]\nintrinsics:\n' +
        ''.join(camera(f'cam{n}', 500 + n, 'camera_matrix') for n in range(4)) +
        camera('camRect0', 900, 'camera_matrix'))
text('dsec/seq/cam_to_cam.yaml', yaml)
text('dsec/nested/calibration/cam_to_cam.yaml', yaml)

with h5('tumvie/mocap-desk/mocap-desk-events_left.h5') as f:
    columns(f.create_group('events'), 1_000_000)
    f['ms_to_idx'] = i.astype(np.uint64)
lens = ('{"camera_type": "kb4", "intrinsics": {"fx": %d, "fy": 1001, "cx": 640, "cy": 360, '
        '"k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4}}')
turned = '{"px": 0, "py": 0, "pz": 0.2, "qx": 1, "qy": 0, "qz": 0, "qw": 0}'
still = '{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}'
text('tumvie/mocap-desk/camera-calibrationA.json',
     '{"value0": {"T_imu_cam": [%s, %s, %s, %s], "intrinsics": [%s], '
     '"resolution": [[1024, 1024], [1024, 1024], [1280, 720], [1280, 720]]}}'
     % (still, still, turned, still, ', '.join(lens % (1000 + n) for n in range(4))))
text('tumvie/mocap-desk/mocap-imu-calibrationA.json',
     '{"value0": {"T_imu_marker": {"px": 0.1, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}}}')
s = 0.5 ** 0.5
text('tumvie/mocap-desk/mocap_data.txt', '# timestamp[us] tx ty tz qx qy qz qw\n' +
     ''.join(f'{1000000 + 50000 * n} {n} 2 3 0 0 {s} {s}\n' for n in range(3)))

R = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
def inverse(T):
    return np.linalg.inv(T)
pose = np.eye(4); pose[:3, :3] = R; pose[:3, 3] = [1, 2, 3]   # T_world_camera
with h5('m3ed/falcon/falcon_data.h5') as f:
    for side, fx in (('left', 1030), ('right', 1040)):
        columns(f.create_group('prophesee/' + side), 1_000_000)
        f[f'prophesee/{side}/ms_map_idx'] = i.astype(np.uint64)
        c = f.create_group(f'prophesee/{side}/calib')
        c['intrinsics'], c['resolution'] = [fx, fx, 630.0, 350.0], [1280, 720]
        c['distortion_coeffs'] = [0.1, 0.2, 0.0, 0.0]
        c['camera_model'], c['distortion_model'] = 'pinhole', 'radtan'
        T = np.eye(4); T[0, 3] = 0.1 * (side == 'right')
        c['T_to_prophesee_left'] = T
with h5('m3ed/falcon/falcon_pose_gt.h5') as f:
    f['Cn_T_C0'] = np.stack([inverse(np.eye(4)), inverse(pose)])
    f['Ln_T_L0'] = np.stack([np.eye(4)] * 2)
    f['ts'] = np.array([1_000_000, 1_090_000], np.int64)

with h5('mvsec/flying1/flying1_data.hdf5') as f:
    for side in ('left', 'right'):
        f[f'davis/{side}/events'] = np.stack([i % 346, i % 260, 1e9 + 1e-3 * i, 2 * (i % 2) - 1], axis=1)
with h5('mvsec/flying1/flying1_gt.hdf5') as f:
    f['davis/left/pose'], f['davis/left/pose_ts'] = np.stack([pose]), np.array([1e9])
text('mvsec/flying1/camchain-imucam-flying.yaml', kalibr(220, 230, lens='equidistant', size='[346, 260]'))

with h5('eds/peanuts/events.h5') as f:
    columns(f, 1_600_000_000_000_000)
text('eds/peanuts/stamped_groundtruth.txt',
     '#timestamp tx ty tz qx qy qz qw\n1600000000.0 1 2 3 0 0 0 1\n1600000000.1 1 2 4 0 0 0 1\n')
text('eds/peanuts/images_timestamps.txt', '1600000000000000\n')
text('eds/peanuts/camchain-calib.yaml', kalibr(760, 560))
)PY";
  const std::string python = "/usr/bin/python3 ";
  if (std::system((python + "-c 'import h5py' 2>/dev/null").c_str()) != 0) {
    WARN("SKIPPED: needs Debian's package python3-h5py");
    return false;
  }
  REQUIRE(std::system((python + folder.write("data_sets.py", script) + " " + folder.path()).c_str()) == 0);
  return true;
}

}  // namespace evbench::testing
