#include "core/events/companions/companions.hpp"

#include <filesystem>
#include <fstream>

#include "core/events/formats.hpp"
#include "core/events/native/native.hpp"
#include "core/events/testing/data_sets.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;
using testing::read_all;
using testing::TemporaryFolder;

namespace {

namespace fs = std::filesystem;

std::string metadata(const EventReader& reader, const std::string& key) {
  for (const auto& [name, value] : reader.info().metadata) {
    if (name == key) return value;
  }
  return "";
}

Matrix3 quarter_turn() { return Eigen::AngleAxisd(M_PI_2, Vector3::UnitZ()).toRotationMatrix(); }

/// A data set of testing::write_data_sets with one of its files rewritten.
std::string with_file(const TemporaryFolder& folder, const std::string& set, const std::string& name,
                      const std::string& content) {
  const fs::path path = folder.file("changed");
  fs::remove_all(path);
  fs::copy(folder.file(set), path, fs::copy_options::recursive);
  folder.write("changed/" + name, content);
  return path.string();
}

void write_file(const fs::path& path, const std::string& content) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << content;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// Checks that calibration or ground truth is refused, and that the events can be read.
template <class T>
void check_refused(const std::string& path, const std::string& name, const std::string& message,
                   std::optional<T> (EventReader::*ask)()) {
  CAPTURE(name, message);
  const auto reader = open_events(path);
  CHECK_THROWS_AS(((*reader).*ask)(), InputError);
  CHECK_THROWS_WITH(((*reader).*ask)(), ContainsSubstring("changed/" + name) && ContainsSubstring(message));
  CHECK(read_all(*reader).size() == 100);
}

}  // namespace

TEST_CASE("DSEC's folder gives the left camera's events and calibration, however its archives were unpacked") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  for (const char* path : {"dsec/seq", "dsec/seq/events.h5", "dsec/nested", "dsec/nested/events/left/events.h5"}) {
    CAPTURE(path);
    const auto reader = open_events(folder.file(path));
    CHECK(reader->info().format == "HDF5 (DSEC)");
    CHECK(reader->info().start == 50'000'000'000);
    CHECK(read_all(*reader).size() == 100);
    REQUIRE(reader->calibration());
    CHECK(reader->calibration()->pinhole.fx == 500.0);
    CHECK(reader->calibration()->pinhole.cy == 240.25);
    CHECK(reader->calibration()->coefficients[3] == -0.004);
    CHECK(reader->calibration()->distortion == DistortionModel::radial_tangential);
    CHECK(reader->info().width == 640);
    CHECK(metadata(*reader, "sensor size") == "the calibration's");
    CHECK_THAT(metadata(*reader, "calibration"), ContainsSubstring("cam_to_cam.yaml (cam0, DSEC's left event camera)"));
    CHECK_FALSE(reader->ground_truth());
  }
  const auto right = open_events(folder.file("dsec/nested/events/right/events.h5"));
  CHECK(right->calibration()->pinhole.fx == 503.0);
  CHECK(right->companion_files() == std::vector<std::string>{folder.file("dsec/nested/calibration/cam_to_cam.yaml")});
}

TEST_CASE("TUM-VIE's motion capture is transformed to the event camera by its calibrations") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto reader = open_events(folder.file("tumvie/mocap-desk"));
  CHECK(reader->info().format == "HDF5 (TUM-VIE)");
  REQUIRE(reader->calibration());
  CHECK(reader->calibration()->pinhole.fx == 1002.0);
  CHECK(reader->calibration()->distortion == DistortionModel::equidistant);
  CHECK(reader->calibration()->coefficients[3] == 0.4);
  CHECK(reader->calibration()->height == 720);
  REQUIRE(reader->ground_truth());
  const auto poses = reader->ground_truth()->poses();
  REQUIRE(poses.size() == 3);
  CHECK(poses[1].t == Approx(1.05));
  // T_world_marker (1 2 3, 90° about z) · T_imu_marker⁻¹ (-0.1 0 0) · T_imu_cam (0 0 0.2, 180° about x)
  CHECK(poses[1].T.p.isApprox(Vector3(1, 1.9, 3.2)));
  CHECK(poses[1].T.R().isApprox(quarter_turn() * Eigen::AngleAxisd(M_PI, Vector3::UnitX()).toRotationMatrix(), 1e-12));
  CHECK(metadata(*reader, "remark").empty());
  CHECK(reader->companion_files().size() == 3);
}

TEST_CASE("TUM-VIE's motion capture without its calibrations stays that of the markers, and a remark says so") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  fs::remove(folder.file("tumvie/mocap-desk/mocap-imu-calibrationA.json"));
  fs::create_directories(folder.file("tumvie/mocap-desk/mocap-desk-vi_gt_data"));
  fs::rename(folder.file("tumvie/mocap-desk/mocap_data.txt"),
             folder.file("tumvie/mocap-desk/mocap-desk-vi_gt_data/mocap_data.txt"));
  const auto reader = open_events(folder.file("tumvie/mocap-desk/mocap-desk-events_left.h5"));
  REQUIRE(reader->ground_truth());
  CHECK(reader->ground_truth()->poses()[1].T.p == Vector3(1, 2, 3));
  CHECK_THAT(metadata(*reader, "remark"), ContainsSubstring("T_world_marker"));
}

TEST_CASE("M3ED's poses are inverted, and transformed to the right camera if its events are read") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto left = open_events(folder.file("m3ed/falcon"));
  CHECK(left->info().format == "HDF5 (M3ED)");
  CHECK(left->calibration()->pinhole.fx == 1030.0);
  REQUIRE(left->ground_truth());
  const auto poses = left->ground_truth()->poses();
  REQUIRE(poses.size() == 2);
  CHECK(poses[1].t == Approx(1.09));
  CHECK(poses[1].T.p.isApprox(Vector3(1, 2, 3)));
  CHECK(poses[1].T.R().isApprox(quarter_turn(), 1e-12));
  const auto right = open_events(folder.file("m3ed/falcon"), {.topic = "prophesee/right"});
  CHECK(right->calibration()->pinhole.fx == 1040.0);
  CHECK(right->ground_truth()->poses()[1].T.p.isApprox(Vector3(1, 2.1, 3)));
  CHECK(metadata(*right, "remark").empty());

  const std::string copy = folder.write("m3ed/falcon/right.txt", "1 2 3 1\n2 2 3 1\n");
  const auto text = open_events(copy);
  REQUIRE(text->ground_truth());
  CHECK(text->ground_truth()->poses()[1].T.p.isApprox(Vector3(1, 2.1, 3)));
  CHECK(text->companion_files().size() == 2);
  fs::rename(folder.file("m3ed/falcon/falcon_data.h5"), folder.file("m3ed/other.h5"));
  const auto alone = open_events(copy);
  CHECK(alone->ground_truth()->poses()[1].T.p.isApprox(Vector3(1, 2, 3)));
  CHECK_THAT(metadata(*alone, "remark"), ContainsSubstring("left event camera: no falcon_data.h5 leads"));
  folder.write("m3ed/falcon/falcon_data.h5", "no HDF5");
  CHECK_THROWS_WITH(open_events(copy)->ground_truth(), ContainsSubstring("falcon_data.h5"));
}

TEST_CASE("MVSEC's poses and Kalibr's calibration are found next to its events") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto left = open_events(folder.file("mvsec/flying1"));
  CHECK(left->calibration()->pinhole.fy == 221.0);
  CHECK(left->calibration()->distortion == DistortionModel::equidistant);
  CHECK(left->info().height == 260);
  CHECK(left->ground_truth()->poses()[0].T.p == Vector3(1, 2, 3));
  const auto right = open_events(folder.file("mvsec/flying1/flying1_data.hdf5"), {.topic = "davis/right"});
  CHECK(right->calibration()->pinhole.fx == 230.0);
  // The right camera is 0.1 m to the right of the left one, which looks along y.
  CHECK(right->ground_truth()->poses()[0].T.p.isApprox(Vector3(1, 2.1, 3)));
  fs::remove(folder.file("mvsec/flying1/camchain-imucam-flying.yaml"));
  const auto alone = open_events(folder.file("mvsec/flying1"), {.topic = "davis/right"});
  CHECK(alone->info().width == 346);
  CHECK_THAT(metadata(*alone, "sensor size"), ContainsSubstring("MVSEC's"));
  CHECK_THAT(metadata(*alone, "remark"), ContainsSubstring("left camera"));
}

TEST_CASE("Of several of Kalibr's calibrations the scenario's own is taken, and none if that is not known") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const std::string flying = folder.file("mvsec/flying1/camchain-imucam-flying.yaml"),
                    driving = folder.file("mvsec/flying1/camchain-imucam-driving.yaml"),
                    own = testing::read_file(flying);
  write_file(driving, replaced(own, "[220, ", "[300, "));
  CHECK(open_events(folder.file("mvsec/flying1"))->calibration()->pinhole.fx == 220.0);
  fs::rename(flying, folder.file("mvsec/flying1/camchain-imucam-walking.yaml"));
  const auto reader = open_events(folder.file("mvsec/flying1"), {.topic = "davis/right"});
  CHECK_THROWS_WITH(reader->calibration(), ContainsSubstring("walking.yaml: is next to camchain-imucam-driving.yaml"));
  CHECK_THROWS_WITH(reader->ground_truth(), ContainsSubstring("walking.yaml: is next to camchain-imucam-driving.yaml"));
  CHECK(reader->info().width == 346);
  CHECK(read_all(*reader).size() == 100);

  write_file(folder.file("eds/peanuts/camchain-other.yaml"),
             testing::read_file(folder.file("eds/peanuts/camchain-calib.yaml")));
  const auto eds = open_events(folder.file("eds/peanuts"));
  CHECK_THROWS_WITH(eds->calibration(), ContainsSubstring("camchain-other.yaml: is next to camchain-calib.yaml"));
  CHECK(eds->info().width == 640);
}

TEST_CASE("The topic says which camera it is, otherwise a whole word of the file's name or its folder's") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const std::string content = testing::read_file(folder.file("dsec/seq/events.h5"));
  const std::string yaml = testing::read_file(folder.file("dsec/seq/cam_to_cam.yaml"));
  const auto fx = [&](const std::string& name) {
    CAPTURE(name);
    const fs::path path = folder.file("dsec/seq/" + name);
    write_file(path, content);
    write_file(path.parent_path() / "cam_to_cam.yaml", yaml);
    return open_events(path.string())->calibration()->pinhole.fx;
  };
  for (const char* name : {"bright_events.h5", "copyright.h5", "left_events.h5", "right/events_left.h5"}) {
    CHECK(fx(name) == 500.0);
  }
  for (const char* name : {"events_right.h5", "a-right.h5", "right.events.h5", "right/some.h5"}) {
    CHECK(fx(name) == 503.0);
  }
  const auto whose = [](const std::string& path, const std::string& topic) {
    return find_companions(std::make_shared<const RecordingFiles>(path), topic).calibration->whose;
  };
  CHECK_THAT(whose(folder.file("dsec/seq/events_right.h5"), "/davis/left/events"), ContainsSubstring("cam0"));
  CHECK_THAT(whose(folder.file("dsec/seq/left_events.h5"), "/davis/right/events"), ContainsSubstring("cam3"));
  CHECK_THAT(whose(folder.file("dsec/seq/events_right.h5"), "/bright/events"), ContainsSubstring("cam3"));
}

TEST_CASE("A file in left/ belongs to the folder above, one in a folder of another name to its own") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  fs::create_directories(folder.file("halves"));
  fs::copy(folder.file("dsec/nested/events/left"), folder.file("halves/left"));
  fs::copy(folder.file("dsec/seq/cam_to_cam.yaml"), folder.file("halves/cam_to_cam.yaml"));
  CHECK(open_events(folder.file("halves"))->calibration());
  CHECK(open_events(folder.file("halves/left/events.h5"))->calibration());
  fs::rename(folder.file("halves"), folder.file("my_events"));
  CHECK(open_events(folder.file("my_events/left/events.h5"))->companion_files().empty());
  CHECK(open_events(folder.file("my_events/left/events.h5"))->calibration());
  fs::rename(folder.file("my_events/left"), folder.file("my_events/bleft"));
  CHECK_FALSE(open_events(folder.file("my_events/bleft/events.h5"))->calibration());
}

TEST_CASE("An option for the sensor's size takes precedence over the files next to the events") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto both = open_events(folder.file("dsec/seq"), {.width = 1280, .height = 720});
  CHECK(both->info().width == 1280);
  CHECK(both->info().height == 720);
  CHECK(metadata(*both, "sensor size").empty());
  CHECK(both->calibration()->width == 640);
  const auto one = open_events(folder.file("dsec/seq"), {.width = 1280});
  CHECK(one->info().width == 1280);
  CHECK(one->info().height == 480);
  const auto eds = open_events(folder.file("eds/peanuts"), {.width = 700, .height = 500});
  CHECK(eds->info().width == 700);
  const auto own = open_events(folder.file("m3ed/falcon"), {.width = 700, .height = 500});
  CHECK(own->info().width == 1280);  // the file says it
}

TEST_CASE("EDS has its event camera second in Kalibr's calibration, and its sensor's size without one") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto reader = open_events(folder.file("eds/peanuts"));
  CHECK(reader->info().format == "HDF5 (x, y, t, p)");
  CHECK(reader->calibration()->pinhole.fx == 560.0);
  CHECK(reader->ground_truth()->poses()[1].T.p == Vector3(1, 2, 4));
  fs::remove(folder.file("eds/peanuts/camchain-calib.yaml"));
  const auto without = open_events(folder.file("eds/peanuts"));
  CHECK(without->info().width == 640);
  CHECK_THAT(metadata(*without, "sensor size"), ContainsSubstring("EDS's"));
  CHECK_FALSE(without->calibration());
}

TEST_CASE("A native copy is taken first, with its own metadata, and with files next to it for what it lacks") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto write = [&](const RecordingHeader& header, const std::string& name) {
    NativeWriter writer(folder.file(name), header);
    writer.write(std::vector<Event>{{7, 1, 2, true}});
    writer.finish();
  };
  RecordingHeader header;
  header.width = 640;
  header.height = 480;
  write(header, "dsec/seq/events.evb");
  CHECK(read_all(*open_events(folder.file("dsec/seq"))).size() == 1);
  CHECK(open_events(folder.file("dsec/seq"))->calibration()->pinhole.fx == 500.0);
  header.calibration = Camera{{100, 100, 320, 240}, DistortionModel::none, {}, 640, 480};
  header.calibration->coefficients.setZero();
  write(header, "dsec/seq/events.evb");
  const auto own = open_events(folder.file("dsec/seq"));
  CHECK(own->calibration()->pinhole.fx == 100.0);
  CHECK(own->companion_files().empty());
  fs::create_directories(folder.file("alone"));
  write(header, "alone/events.evb");
  CHECK(read_all(*open_events(folder.file("alone"))).size() == 1);
  CHECK(holds_events(folder.file("alone")));
  fs::create_directories(folder.file("none"));
  CHECK_FALSE(holds_events(folder.file("none")));
  CHECK_THROWS_WITH(open_events(folder.file("none")), ContainsSubstring("is a folder that is no recording"));
}

TEST_CASE("A folder with several recordings is refused, each file of it is read with its own ground truth") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  fs::copy(folder.file("mvsec/flying1/flying1_data.hdf5"), folder.file("mvsec/flying1/flying2_data.hdf5"));
  CHECK_THROWS_WITH(open_events(folder.file("mvsec/flying1")),
                    ContainsSubstring("several recordings (flying1_data.hdf5, flying2_data.hdf5)"));
  CHECK(open_events(folder.file("mvsec/flying1/flying1_data.hdf5"))->ground_truth());
  CHECK_FALSE(open_events(folder.file("mvsec/flying1/flying2_data.hdf5"))->ground_truth());
}

TEST_CASE("Calibrations that are broken are refused with the file, the key, and what was expected", "[slow]") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto refused = [&](const std::string& set, const std::string& name, const std::string& content,
                           const std::string& message) {
    check_refused(with_file(folder, set, name, content), name, message, &EventReader::calibration);
  };
  const std::string dsec = testing::read_file(folder.file("dsec/seq/cam_to_cam.yaml"));
  const auto yaml = [&](const std::string& from, const std::string& to, const std::string& message) {
    refused("dsec/seq", "cam_to_cam.yaml", replaced(dsec, from, to), message);
  };
  yaml("intrinsics:", "other:", "has no intrinsics");
  yaml("cam0:", "camera:", "intrinsics: has no cam0");
  yaml("[500, 501, 320.5, 240.25]", "[500, 501]", "cam0: camera_matrix: is a list of 2; expected 4 numbers");
  yaml("[500, 501, 320.5, 240.25]", "[0, 501, 320.5, 240.25]", "the first two > 0");
  yaml("[500, 501, 320.5, 240.25]", "[500, .nan, 320.5, 240.25]", "camera_matrix[1]: is");
  yaml("[500, 501, 320.5, 240.25]", "fast", "expected 4 numbers");
  yaml("radtan", "fov", "distortion_model: is \"fov\"; expected radtan, equidistant or none");
  yaml("pinhole", "omni", "camera_model: is \"omni\"; expected pinhole");
  yaml("[640, 480]", "[640, 1e9]", "resolution of 1000000000 px");
  yaml("[640, 480]", "[[[", "is not the YAML of a calibration");
  refused("dsec/seq", "cam_to_cam.yaml", "", "has no intrinsics");
  refused("dsec/seq", "cam_to_cam.yaml", "a: &a [*a]\n", "is not the YAML of a calibration");
  std::string bomb = "a0: &a0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 12; ++i) {
    const auto before = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 9; ++k) bomb += "," + before;
    bomb += "]\n";
  }
  refused("dsec/seq", "cam_to_cam.yaml", bomb, "more values or levels");
  refused("dsec/seq", "cam_to_cam.yaml", std::string(2 << 20, ' '), "expected a calibration of at most");
  refused("mvsec/flying1", "camchain-imucam-flying.yaml", "cam1: {}\n", "has no cam0");

  const std::string json = "camera-calibrationA.json";
  const std::string tumvie = testing::read_file(folder.file("tumvie/mocap-desk/" + json));
  refused("tumvie/mocap-desk", json, "{", "is not JSON");
  refused("tumvie/mocap-desk", json, "[]", "has no value0");
  refused("tumvie/mocap-desk", json, replaced(tumvie, "\"fx\": 1002", "\"fx\": \"x\""), "intrinsics: fx: is \"x\"");
  refused("tumvie/mocap-desk", json, replaced(tumvie, ", [1280, 720], [1280, 720]", ""), "resolution");
  refused("tumvie/mocap-desk", "camera-calibrationB.json", tumvie, "is next to camera-calibrationA.json");
}

TEST_CASE("Ground truths that are broken are refused with the file, the place, and what was expected", "[slow]") {
  const TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const auto refused = [&](const std::string& set, const std::string& name, const std::string& content,
                           const std::string& message) {
    check_refused(with_file(folder, set, name, content), name, message, &EventReader::ground_truth);
  };
  refused("tumvie/mocap-desk", "mocap_data.txt", "1000000 0 0 0 0 0 0\n", "mocap_data.txt:1: has 7 columns");
  refused("tumvie/mocap-desk", "mocap_data.txt", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "increasing");
  refused("tumvie/mocap-desk", "mocap-imu-calibrationA.json", R"({"value0": {}})", "value0: has no T_imu_marker");
  refused("tumvie/mocap-desk", "mocap-imu-calibrationA.json",
          R"({"value0": {"T_imu_marker": {"px":0,"py":0,"pz":0,"qx":0,"qy":0,"qz":0,"qw":2}}})",
          "quaternion of norm 2");
  refused("eds/peanuts", "stamped_groundtruth.txt", "# nothing\n", "holds no pose");
  refused("m3ed/falcon", "falcon_pose_gt.h5", "no HDF5", "HDF5 cannot read this");
  refused("m3ed/falcon", "falcon_pose_gt.h5", testing::read_file(folder.file("mvsec/flying1/flying1_gt.hdf5")),
          "/Cn_T_C0: is missing");
  const std::string whole = testing::read_file(folder.file("m3ed/falcon/falcon_pose_gt.h5"));
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 8) {
    const auto reader = open_events(with_file(folder, "m3ed/falcon", "falcon_pose_gt.h5", whole.substr(0, size)));
    CHECK_THROWS_AS(reader->ground_truth(), InputError);
  }
}
