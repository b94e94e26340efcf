#include "core/sources/recording.hpp"

#include <cstdlib>
#include <filesystem>

#include "core/events/native/native.hpp"
#include "core/events/testing/bag_writer.hpp"
#include "core/events/testing/data_sets.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

const char* const kCalibration = "200 200 120 90 0 0 0 0 0\n";
const char* const kGroundTruth = "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n";

Recording open(const std::string& json, const std::string& folder) {
  return Recording(read_options<Recording::Options>(parse_json(json), "config"), {0, folder});
}

}  // namespace

TEST_CASE("A recording reads calibration and ground truth from a folder relative to the config") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt", kGroundTruth);
  const Recording source = open(R"({"folder": "."})", folder.path());
  CHECK(source.camera().pinhole.fx == 200.0);
  CHECK(source.camera().width == 240);
  CHECK(source.ground_truth().size() == 3);
  CHECK(source.time_range().from == 1.0);
  CHECK(source.time_range().to == 3.0);
  CHECK(source.files().size() == 2);
  CHECK_FALSE(source.true_tracks());
}

TEST_CASE("A recording's time offset moves the ground truth, its time range does not cut it") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt", kGroundTruth);
  const Recording source = open(R"({"folder": ".", "time_offset": 0.5, "time_range": [2, 5]})", folder.path());
  CHECK(source.ground_truth().start() == 1.5);
  CHECK(source.ground_truth().size() == 3);
  CHECK(source.time_range().to == 5.0);
  REQUIRE(source.remarks().size() == 1);
  CHECK_THAT(source.remarks()[0], ContainsSubstring("covers 1.500 to 3.500"));
}

TEST_CASE("A recording without ground truth needs a time range and says that it can't be scored") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  CHECK_THROWS_WITH(open(R"({"folder": "."})", folder.path()),
                    ContainsSubstring("without ground truth and events, time_range must be given"));
  const Recording source = open(R"({"folder": ".", "time_range": [0, 1]})", folder.path());
  CHECK(source.ground_truth().empty());
  CHECK_THAT(source.remarks().at(0), ContainsSubstring("can't be scored"));
}

TEST_CASE("A recording without ground truth is used from its first event to its last") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("events.txt", "1.5 7 1 1\n1.6 8 1 0\n1.75 8 2 0\n");
  const Recording source = open(R"({"folder": "."})", folder.path());
  CHECK(source.time_range().from == Approx(1.5).epsilon(1e-12));
  CHECK(source.time_range().to == Approx(1.75).epsilon(1e-12));
  std::vector<Event> events;
  const auto stream = source.events();
  REQUIRE(stream->read(events));
  CHECK(events.size() == 3);
  folder.write("events.txt", "1.5 7 1 1\n");
  CHECK_THROWS_WITH(open(R"({"folder": "."})", folder.path()), ContainsSubstring("has no events over any time"));
}

TEST_CASE("A recording's text is read by named columns, and with however many faults where that is asked for") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt", kGroundTruth);
  folder.write("events.txt", "5 1.5 7 1\n6 1.6 8 0\n999 1.7 8 0\n");  // the last one is outside the sensor
  const auto read_all = [&](const char* more) {
    const Recording source =
        open(std::string(R"({"folder": ".", "width": 240, "height": 180, "columns": "x,t_s,y,p")") + more + "}",
             folder.path());
    const auto stream = source.events();
    std::vector<Event> all, events;
    while (stream->read(events)) all.insert(all.end(), events.begin(), events.end());
    return all;
  };
  CHECK_THROWS_WITH(read_all(""), ContainsSubstring("33.3 % of the events") && ContainsSubstring("source.lenient"));
  const std::vector<Event> all = read_all(R"(, "lenient": true)");
  REQUIRE(all.size() == 2);
  CHECK(all[1].t == 1'600'000);
  CHECK(all[1].x == 6);
  CHECK(all[1].y == 8);
}

TEST_CASE("A recording reads RobotEvt ground truth") {
  const testing::TemporaryFolder folder;
  folder.write("cam.txt", kCalibration);
  folder.write("gt.txt", "0 1 0 0 0 1 0 0 0 1 1 2 3\n1 1 0 0 0 1 0 0 0 1 1 2 4\n");
  const Recording source =
      open(R"({"calibration": "cam.txt", "ground_truth": "gt.txt", "ground_truth_format": "robotevt"})", folder.path());
  CHECK(source.ground_truth().poses()[1].T.p.z() == 4.0);
}

TEST_CASE("A recording reads ground truth as EuRoC and KITTI lay it out, and says what it took it for") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt",
               "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n1000000000,1,2,3,1,0,0,0\n"
               "2000000000,1,2,4,1,0,0,0\n");
  folder.write("kitti.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 4\n");
  folder.write("times.txt", "1000\n2000\n");
  const Recording euroc = open(R"({"folder": "."})", folder.path());
  CHECK(euroc.ground_truth().end() == 2.0);
  CHECK(euroc.ground_truth().poses()[1].T.p.z() == 4.0);
  CHECK_THAT(euroc.remarks().at(0), ContainsSubstring("times in nanoseconds"));
  const Recording kitti = open(R"({"folder": ".", "ground_truth": "kitti.txt", "ground_truth_times": "times.txt",
                                   "ground_truth_time_unit": "ms"})",
                               folder.path());
  CHECK(kitti.ground_truth().end() == 2.0);
  CHECK(kitti.files().size() == 3);
  CHECK_THROWS_WITH(open(R"({"folder": ".", "ground_truth": "kitti.txt"})", folder.path()),
                    ContainsSubstring("has no time"));
  CHECK_THROWS_WITH(open(R"({"folder": ".", "ground_truth": "kitti.txt", "ground_truth_times": "times.txt",
                             "time_range": [1, 2]})",
                         folder.path()),
                    ContainsSubstring("in milliseconds (ground_truth_time_unit: ms) they would go from 1 to 2 s"));
}

TEST_CASE("A recording's ground truth has its quaternions in the order that is asked for, in the usual file, too") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt", "0 1 2 3 0.6 0.8 0 0\n1 1 2 3 0.6 0.8 0 0\n");
  CHECK(open(R"({"folder": "."})", folder.path()).ground_truth().poses()[0].T.q.x() == Approx(0.6));
  const Recording source = open(R"({"folder": ".", "ground_truth_quaternion": "wxyz"})", folder.path());
  CHECK(source.ground_truth().poses()[0].T.q.w() == Approx(0.6));
  CHECK(source.ground_truth().poses()[0].T.q.x() == Approx(0.8));
}

TEST_CASE("A recording takes one camera of a Kalibr chain, with its size and lens") {
  const testing::TemporaryFolder folder;
  folder.write("groundtruth.txt", kGroundTruth);
  std::string chain;
  for (const char* name : {"cam0", "cam1"}) {
    chain += std::string(name) +
             ":\n  camera_model: pinhole\n  intrinsics: [700, 701, 330, 250]\n"
             "  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0, 0, 0]\n  resolution: [640, 480]\n";
  }
  folder.write("camchain.yaml", chain);
  const std::string json = R"({"calibration": "camchain.yaml", "ground_truth": "groundtruth.txt")";
  const Recording source = open(json + R"(, "camera": "cam1"})", folder.path());
  CHECK(source.camera().width == 640);
  CHECK(source.camera().distortion == DistortionModel::equidistant);
  CHECK_THROWS_WITH(open(json + "}", folder.path()), ContainsSubstring("holds cam0, cam1"));
}

TEST_CASE("A recording says that its calibration has no lens") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", "200 200 120 90\n");
  folder.write("groundtruth.txt", kGroundTruth);
  const Recording source = open(R"({"folder": "."})", folder.path());
  CHECK(source.camera().distortion == DistortionModel::none);
  CHECK_THAT(source.remarks().at(0), ContainsSubstring("no lens"));
}

TEST_CASE("A recording refuses what is missing or makes no sense, and says what") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  folder.write("groundtruth.txt", kGroundTruth);
  CHECK_THROWS_WITH(open("{}", folder.path()),
                    ContainsSubstring("config: expected at least one of dataset, folder, events, calibration"));
  CHECK_THROWS_WITH(open(R"({"folder": "nowhere"})", folder.path()), ContainsSubstring("calib.txt: no such file"));
  CHECK_THROWS_WITH(open(R"({"folder": ".", "ground_truth": "no.txt"})", folder.path()),
                    ContainsSubstring("no such file"));
  CHECK_THROWS_WITH(open(R"({"folder": ".", "time_range": [3, 2]})", folder.path()),
                    ContainsSubstring("time_range: is [3,2]; expected rising numbers"));
  CHECK_THROWS_WITH(open(R"({"folder": ".", "time_range": [10, 12]})", folder.path()),
                    ContainsSubstring("does not meet"));
  CHECK_THROWS_WITH(open(R"({"folder": "${EVBENCH_NOT_SET}/x"})", folder.path()), ContainsSubstring("EVBENCH_NOT_SET"));
  CHECK_THROWS_AS(open(R"({"folder": ".", "distortion": "fisheye"})", folder.path()), InputError);
}

TEST_CASE("A recording is found by the name of a dataset, and gives its events") {
  const testing::TemporaryFolder folder;
  ::setenv("EVBENCH_DATASETS", folder.path().c_str(), 1);
  const std::string json = R"({"dataset": "ecd/dynamic_6dof"})";
  CHECK_THROWS_WITH(open(json, ""),
                    ContainsSubstring(".dataset: ") && ContainsSubstring("evbench dataset get ecd/dynamic_6dof"));
  std::filesystem::create_directories(folder.file("ecd/dynamic_6dof"));
  folder.write("ecd/dynamic_6dof/calib.txt", kCalibration);
  folder.write("ecd/dynamic_6dof/groundtruth.txt", kGroundTruth);
  NativeWriter writer(folder.file("ecd/dynamic_6dof/events.evb"), {});
  writer.write(std::vector<Event>{{1500000, 239, 1, true}});
  writer.finish();
  const Recording source = open(json, "");
  CHECK(source.ground_truth().size() == 3);
  const auto reader = source.events();
  REQUIRE(reader);
  CHECK(reader->info().width == 240);
  CHECK(source.event_files() == std::vector<std::string>{folder.file("ecd/dynamic_6dof/events.evb")});
  std::vector<Event> events;
  REQUIRE(reader->read(events));
  CHECK(events == std::vector<Event>{{1500000, 239, 1, true}});
  CHECK_THROWS_WITH(open(R"({"dataset": "ecd/dynamic_6dof", "folder": "."})", ""),
                    ContainsSubstring("expected one of them"));
  ::unsetenv("EVBENCH_DATASETS");
}

TEST_CASE("Public data sets are recordings by their names alone, with calibration, ground truth and time range",
          "[slow]") {
  const testing::TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  ::setenv("EVBENCH_DATASETS", folder.path().c_str(), 1);
  const struct {
    const char* name;
    double fx;
    int width;
    std::size_t poses, files;
    double from, to;
  } cases[] = {{"dsec/seq", 500, 640, 0, 1, 50'000, 50'000.099},
               {"tumvie/mocap-desk", 1002, 1280, 3, 3, 1, 1.1},
               {"m3ed/falcon", 1030, 1280, 2, 1, 1, 1.09},
               {"eds/peanuts", 560, 640, 2, 2, 1.6e9, 1.6e9 + 0.1}};
  for (const auto& [name, fx, width, poses, files, from, to] : cases) {
    CAPTURE(name);
    const Recording source = open(std::string(R"({"dataset": ")") + name + "\"}", "");
    CHECK(source.camera().pinhole.fx == fx);
    CHECK(source.camera().width == width);
    CHECK(source.ground_truth().size() == poses);
    CHECK(source.files().size() == files);
    CHECK(source.time_range().from == Approx(from).epsilon(1e-12));
    CHECK(source.time_range().to == Approx(to).epsilon(1e-12));
    CHECK(source.remarks().size() == (poses == 0 ? 1 : 0));
    CHECK(source.events()->info().count == 100);
  }
  ::unsetenv("EVBENCH_DATASETS");
}

TEST_CASE("A recording is a file of events alone where that says all, or what it lacks is named") {
  const testing::TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const Recording source = open(R"({"events": "m3ed/falcon/falcon_data.h5"})", folder.path());
  CHECK(source.camera().pinhole.fx == 1030.0);
  CHECK(source.ground_truth().size() == 2);
  const Recording named =
      open(R"({"folder": "m3ed/falcon", "ground_truth": "eds/peanuts/stamped_groundtruth.txt"})", folder.path());
  CHECK(named.ground_truth().start() == 1.6e9);
  CHECK(named.files() == std::vector<std::string>{folder.file("eds/peanuts/stamped_groundtruth.txt")});
  std::filesystem::remove(folder.file("dsec/seq/cam_to_cam.yaml"));
  CHECK_THROWS_WITH(open(R"({"folder": "dsec/seq"})", folder.path()), ContainsSubstring("no calibration is known of"));
}

TEST_CASE("A recording's usual files are read as the options say") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", "200 201 120 90 0.1 0.2 0.3 0.4\n");
  folder.write("groundtruth.txt", "0 1 0 0 0 1 0 0 0 1 1 2 3\n1 1 0 0 0 1 0 0 0 1 1 2 4\n");
  const Recording source = open(
      R"({"folder": ".", "distortion": "equidistant", "ground_truth_format": "robotevt", "width": 346, "height": 260})",
      folder.path());
  CHECK(source.camera().distortion == DistortionModel::equidistant);
  CHECK(source.camera().width == 346);
  CHECK(source.ground_truth().poses()[1].T.p.z() == 4.0);
}

TEST_CASE("A recording of a calibration alone has no events, a file of them is named in its own option") {
  const testing::TemporaryFolder folder;
  folder.write("calib.txt", kCalibration);
  CHECK(open(R"({"calibration": "calib.txt", "time_range": [0, 1]})", folder.path()).events() == nullptr);
  NativeWriter writer(folder.file("a.evb"), {});
  writer.finish();
  const std::string json = R"({"calibration": "calib.txt", "time_range": [0, 1], "events": "a.evb"})";
  CHECK(open(json, folder.path()).events()->info().count == 0);
}

TEST_CASE("The real poster_translation opens with its ground truth") {
  if (!testing::data_file("poster_translation/groundtruth.txt")) return;
  const Recording source = open(R"({"folder": "${EVBENCH_DATA}/poster_translation", "time_range": [0, 3.05]})", "");
  CHECK(source.ground_truth().size() == 11768);
  CHECK(source.camera().pinhole.fx == Approx(199.092366542));
}

TEST_CASE("A run's log names the topics of a bag that calibration and ground truth are from, options choose others") {
  using namespace testing::bag_writer;
  const testing::TemporaryFolder folder;
  const std::int64_t second = 1'000'000'000;
  const auto write = [&](const std::string& info) {
    return folder.write(
        "a.bag", bag_of({{"/dvs/events", "dvs_msgs/EventArray"},
                         {"/rgb/camera_info", "sensor_msgs/CameraInfo"},
                         {info, "sensor_msgs/CameraInfo"},
                         {"/box/pose", "geometry_msgs/PoseStamped"},
                         {"/dvs/pose", "geometry_msgs/PoseStamped"}},
                        {{{0, second, event_array(second, 10)},
                          {1, second, camera_info(640, 480)},
                          {2, second, info == "/dvs/camera_info" ? camera_info(240, 180) : camera_info(320, 240)},
                          {3, second, pose_stamped(second, 1000.0)},
                          {4, second, pose_stamped(second, 1.0)},
                          {3, 2 * second, pose_stamped(2 * second, 1000.0)},
                          {4, 2 * second, pose_stamped(2 * second, 2.0)}}}));
  };
  write("/dvs/camera_info");
  const Recording source = open(R"({"events": "a.bag"})", folder.path());
  CHECK(source.camera().width == 240);
  CHECK(source.ground_truth().poses()[0].T.p.x() == 1.0);
  std::string remarks;
  for (const std::string& remark : source.remarks()) remarks += remark + "\n";
  CHECK_THAT(remarks, ContainsSubstring("camera info in: /dvs/camera_info (240x180 pixels)\n") &&
                          ContainsSubstring("ground truth in: /dvs/pose\n") &&
                          ContainsSubstring("/box/pose, /dvs/pose") && ContainsSubstring("source.ground_truth_topic"));
  const Recording box = open(R"({"events": "a.bag", "ground_truth_topic": "/box/pose"})", folder.path());
  CHECK(box.ground_truth().poses()[0].T.p.x() == 1000.0);
  CHECK_THROWS_WITH(open(R"({"events": "a.bag", "camera_info_topic": "/rgb/camera_info"})", folder.path()),
                    ContainsSubstring("640x480") && ContainsSubstring("240x180"));

  write("/other/camera_info");
  CHECK_THROWS_WITH(open(R"({"events": "a.bag"})", folder.path()),
                    ContainsSubstring("no calibration is known") && ContainsSubstring("640x480") &&
                        ContainsSubstring("320x240") && ContainsSubstring("240x180"));
}
