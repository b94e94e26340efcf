#include "core/events/ros/topic_choice.hpp"

#include "core/events/testing/bag_writer.hpp"
#include "core/events/testing/recordings.hpp"
#include "core/support/error.hpp"

using namespace evbench;
using namespace evbench::testing::bag_writer;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The name of the topic that is chosen without an option.
std::string chosen_of(const std::vector<std::string>& names, const std::string& events) {
  std::vector<ros::Candidate> candidates;
  for (const std::string& name : names) candidates.push_back({{name, "type", 1, true, {}}, name});
  const auto place = ros::choose("a.bag", {"poses", "--option"}, candidates, "", events);
  return place ? names[*place] : "";
}

const BagConnection kEventsTopic{"/davis/left/events", "dvs_msgs/EventArray"};

/// One message each of some topics, and events of 240x180 pixels.
std::unique_ptr<EventReader> open_bag(const testing::TemporaryFolder& folder,
                                      const std::vector<std::pair<std::string, std::string>>& infos,
                                      const std::vector<std::string>& poses, const ReadOptions& options = {}) {
  std::vector<BagConnection> connections{kEventsTopic};
  std::vector<BagMessage> messages{{0, 1'000'000'000, event_array(1'000'000'000, 10)}};
  const auto add = [&](const std::string& topic, const std::string& type, const std::string& data) {
    messages.push_back({static_cast<std::uint32_t>(connections.size()), 1'000'000'000, data});
    connections.push_back({topic, type});
  };
  for (const auto& [topic, data] : infos) add(topic, "sensor_msgs/CameraInfo", data);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    add(poses[i], "geometry_msgs/PoseStamped", pose_stamped(1'000'000'000, static_cast<double>(i)));
  }
  return open_events(folder.write("a.bag", bag_of(connections, {messages})), options);
}

std::string metadata_of(const EventReader& reader, const std::string& key) {
  std::string all;
  for (const auto& [name, text] : reader.info().metadata) all += name == key ? text + "\n" : "";
  return all;
}

}  // namespace

TEST_CASE(
    "Of several topics that is chosen which goes with the events' by namespace, by words, by an event camera's "
    "name") {
  CHECK(chosen_of({"/vicon/box/pose", "/vicon/davis/pose"}, "/dvs/events") == "/vicon/davis/pose");
  CHECK(chosen_of({"/vicon/right/pose", "/vicon/left/pose"}, "/davis/left/events") == "/vicon/left/pose");
  CHECK(chosen_of({"/dvs/image/camera_info", "/dvs/camera_info", "/camera_info"}, "/dvs/events") == "/dvs/camera_info");
  CHECK(chosen_of({"/anything"}, "/dvs/events") == "/anything");
  CHECK(chosen_of({}, "/dvs/events").empty());
  for (const auto& names : {std::vector<std::string>{"/vicon/box/pose", "/vicon/table/pose"},
                            {"/vicon/davis_1/pose", "/vicon/davis_2/pose"}}) {
    CHECK_THROWS_WITH(chosen_of(names, "/dvs/events"),
                      ContainsSubstring(names[0] + ", " + names[1]) && ContainsSubstring("--option"));
  }
}

TEST_CASE("A choice among topics of poses is reported, an option makes it, and indistinguishable topics are an error") {
  const testing::TemporaryFolder folder;
  const std::vector<std::string> bodies{"/vicon/box/pose", "/vicon/davis/pose"};
  auto reader = open_bag(folder, {}, bodies);
  CHECK(reader->ground_truth()->poses()[0].T.p.x() == 1.0);
  CHECK(metadata_of(*reader, kGroundTruthIn) == "/vicon/davis/pose\n");
  CHECK_THAT(metadata_of(*reader, kTopicChoice),
             ContainsSubstring("/vicon/box/pose, /vicon/davis/pose") && ContainsSubstring("--ground-truth-topic"));
  reader = open_bag(folder, {}, bodies, {.ground_truth_topic = "/vicon/box/pose"});
  CHECK(reader->ground_truth()->poses()[0].T.p.x() == 0.0);
  CHECK(metadata_of(*reader, kTopicChoice).empty());
  CHECK_THROWS_WITH(open_bag(folder, {}, bodies, {.ground_truth_topic = "/vicon/bo"}),
                    ContainsSubstring("'/vicon/bo'") && ContainsSubstring("/vicon/davis/pose"));
  CHECK_THROWS_WITH(open_bag(folder, {}, bodies, {.ground_truth_topic = kEventsTopic.topic}),
                    ContainsSubstring("has no poses in topic"));
  CHECK_THROWS_WITH(open_bag(folder, {}, {"/a/pose", "/b/pose"})->ground_truth(),
                    ContainsSubstring("/a/pose, /b/pose") && ContainsSubstring("--ground-truth-topic"));
}

TEST_CASE("A topic of ground truth or camera info that is named is in the recording, whatever its format") {
  const testing::TemporaryFolder folder;
  const std::string text = folder.write("events.txt", "0.1 1 2 1\n0.2 1 2 1\n");
  CHECK_THROWS_WITH(open_events(text, {.ground_truth_topic = "/pose"}),
                    ContainsSubstring("has no topic /pose; it has none"));
  CHECK_THROWS_WITH(open_events(text, {.camera_info_topic = "/info"}), ContainsSubstring("has no topic /info"));
}

TEST_CASE("A camera info of another size than the events is passed over, or refused with both sizes") {
  const testing::TemporaryFolder folder;
  const std::string own = camera_info(240, 180),
                    colour = camera_info(640, 480, "plumb_bob", {}, {500, 0, 320, 0, 500, 240, 0, 0, 1});
  auto reader = open_bag(folder, {{"/camera/camera_info", colour}, {"/davis/left/camera_info", own}}, {});
  CHECK(reader->calibration()->width == 240);
  CHECK(metadata_of(*reader, kCameraInfoIn) == "/davis/left/camera_info (240x180 pixels)\n");
  CHECK_THAT(metadata_of(*reader, kTopicChoice), ContainsSubstring("/camera/camera_info (640x480 pixels)"));
  reader = open_bag(folder, {{"/camera/camera_info", colour}}, {});
  CHECK_FALSE(reader->calibration());
  CHECK_THAT(metadata_of(*reader, kUnusableCalibration), ContainsSubstring("640x480") && ContainsSubstring("240x180"));
  reader = open_bag(folder, {{"/camera/camera_info", colour}}, {}, {.camera_info_topic = "/camera/camera_info"});
  CHECK_THROWS_WITH(reader->calibration(), ContainsSubstring("640x480") && ContainsSubstring("240x180"));
  reader = open_bag(folder, {{"/a/camera_info", own}, {"/b/camera_info", own}}, {});
  CHECK_THROWS_WITH(reader->calibration(), ContainsSubstring("/a/camera_info (240x180 pixels), /b/camera_info") &&
                                               ContainsSubstring("--camera-info-topic"));
  reader = open_bag(folder, {{"/davis/left/camera_info", camera_info(0, 0)}}, {});
  CHECK(reader->calibration()->width == 240);
}

TEST_CASE("A camera info is checked as a calibration file is") {
  const testing::TemporaryFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto read = [&](const std::string& model, const std::vector<double>& D,
                        const std::array<double, 9>& K = {199, 0, 120, 0, 198, 90, 0, 0, 1}) {
    return open_bag(folder, {{"/davis/left/camera_info", camera_info(240, 180, model, D, K)}}, {})->calibration();
  };
  CHECK(read("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5})->distortion == DistortionModel::radial_tangential);
  CHECK(read("plumb_bob", {})->distortion == DistortionModel::none);
  for (const char* name : {"equidistant", "fisheye", "kannala_brandt", "kannala_brandt4"}) {
    CHECK(read(name, {0.1, 0.2, 0.3, 0.4})->distortion == DistortionModel::equidistant);
  }
  CHECK(read("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0})->coefficients[4] == 0.5);
  CHECK_THROWS_WITH(read("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0}),
                    ContainsSubstring("/davis/left/camera_info") && ContainsSubstring("rational_polynomial"));
  for (const char* name : {"fov", "thin_prism_fisheye", "?"}) {
    CHECK_THROWS_WITH(read(name, {0.1, 0.2, 0.3, 0.4}), ContainsSubstring("is \"" + std::string(name) + "\""));
  }
  CHECK_THROWS_WITH(read("", {0.1, 0.2, 0.3, 0.4}), ContainsSubstring("distortion_model \"\""));
  for (const double wrong : {nan, inf}) {
    CHECK_THROWS_AS(read("plumb_bob", {0.1, wrong, 0.3, 0.4, 0.5}), InputError);
    CHECK_THROWS_AS(read("plumb_bob", {}, {wrong, 0, 120, 0, 198, 90, 0, 0, 1}), InputError);
    CHECK_THROWS_AS(read("plumb_bob", {}, {199, 0, wrong, 0, 198, 90, 0, 0, 1}), InputError);
  }
  CHECK_THROWS_WITH(read("plumb_bob", {}, {199, 0, 120, 0, 198, 90, 0, 0, 2}),
                    ContainsSubstring("is no camera matrix"));
  const std::string whole = camera_info(240, 180);
  const std::size_t binning = whole.size() - 200 + 21 * sizeof(double);  // behind R and P; then the region of interest
  for (const std::size_t field : {binning, binning + 4, binning + 8, binning + 12, binning + 16, binning + 20}) {
    std::string partial = whole;
    partial[field] = 2;
    CHECK_THROWS_WITH(open_bag(folder, {{"/davis/left/camera_info", partial}}, {})->calibration(),
                      ContainsSubstring("/davis/left/camera_info: is of a binned image or of a region of interest"));
  }
  CHECK_THROWS_WITH(read("plumb_bob", {}, {0, 0, 120, 0, 0, 90, 0, 0, 1}), ContainsSubstring("fx fy cx cy 0 0 120 90"));
  CHECK_THROWS_WITH(read("plumb_bob", {}, {199, 0, 300, 0, 198, 90, 0, 0, 1}), ContainsSubstring("240x180"));
  CHECK_FALSE(read("plumb_bob", {}, {}));  // ROS's sign for a camera that is not calibrated

  const auto fov = testing::data_file("cases/camera_info/fov.bag");
  if (fov) CHECK_THROWS_WITH(open_events(*fov)->calibration(), ContainsSubstring("fov"));
}
