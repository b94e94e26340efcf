#include "core/events/native/native.hpp"
#include "core/sources/recording.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

// Which size of the sensor a recording has where its file, the options, the calibration or nothing says one.

namespace {

constexpr Event kCorner{1'500'000, 345, 259, true};  // of a sensor of 346x260 pixels

/// A native file whose header says a size, 0: none, text that says none, and calibrations.
class Folder {
 public:
  Folder() {
    for (const auto& [name, width, height] : {std::tuple("said.evb", 346, 260), {"unsaid.evb", 0, 0}}) {
      RecordingHeader header;
      header.width = width;
      header.height = height;
      NativeWriter writer(folder_.file(name), header);
      writer.write(std::vector<Event>{{1'000'000, 5, 5, true}, kCorner});
      writer.finish();
    }
    folder_.write("events.txt", "1.0 5 5 1\n1.5 345 259 1\n");
    folder_.write("calib.txt", "200 200 120 90 0 0 0 0 0\n");
    for (const char* size : {"240, 180", "346, 260"}) {
      folder_.write(std::string(size, 3) + ".yaml",
                    "cam0:\n  camera_model: pinhole\n  intrinsics: [200, 200, 120, 90]\n  distortion_model: radtan\n"
                    "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [" +
                        std::string(size) + "]\n");
    }
  }

  Recording open(const std::string& options) const {
    const Json json = parse_json("{\"time_range\": [0, 2], " + options + "}");
    return Recording(evbench::read_options<Recording::Options>(json, "config"), {0, folder_.path()});
  }

 private:
  testing::TemporaryFolder folder_;
};

std::vector<Event> events_given_by(const Source& source) {
  const auto stream = source.events();
  std::vector<Event> all, events;
  while (stream->read(events)) all.insert(all.end(), events.begin(), events.end());
  return all;
}

}  // namespace

TEST_CASE(
    "The size that a recording states takes precedence over the usual one, and unequal ones are refused with both") {
  const Folder folder;
  const Recording own = folder.open(R"("events": "said.evb", "calibration": "calib.txt")");
  CHECK(own.camera().width == 346);
  CHECK(own.camera().height == 260);
  CHECK(own.size_assumption().empty());
  CHECK(events_given_by(own).back() == kCorner);
  CHECK(folder.open(R"("events": "said.evb", "calibration": "346.yaml")").camera().width == 346);
  for (const char* options : {R"("events": "said.evb", "calibration": "240.yaml")",
                              R"("events": "said.evb", "calibration": "calib.txt", "width": 240, "height": 180)",
                              R"("events": "events.txt", "calibration": "346.yaml", "width": 240, "height": 180)"}) {
    CAPTURE(options);
    CHECK_THROWS_WITH(folder.open(options), ContainsSubstring("240x180") && ContainsSubstring("346x260"));
  }
  CHECK_THROWS_WITH(folder.open(R"("events": "events.txt", "calibration": "calib.txt", "width": 240)"),
                    ContainsSubstring("expected both or none"));
}

TEST_CASE("A size that nothing states is assumed and reported, and an event outside it is an error that says so") {
  const Folder folder;
  for (const char* events : {"events.txt", "unsaid.evb"}) {
    CAPTURE(events);
    const std::string files = std::string(R"("events": ")") + events + R"(", "calibration": "calib.txt")";
    const Recording assumed = folder.open(files);
    CHECK(assumed.camera().width == 240);
    CHECK_THAT(assumed.size_assumption(), ContainsSubstring("240x180 pixels is assumed"));
    CHECK_THAT(assumed.remarks().front(), ContainsSubstring("240x180 pixels is assumed"));
    CHECK_THROWS_WITH(events_given_by(assumed), ContainsSubstring("pixel (345, 259)") && ContainsSubstring("240x180") &&
                                                    ContainsSubstring("source.width"));
    CHECK(events_given_by(folder.open(files + R"(, "lenient": true)")).size() == 1);
    const Recording stated = folder.open(files + R"(, "width": 346, "height": 260)");
    CHECK(stated.size_assumption().empty());
    CHECK(events_given_by(stated).back() == kCorner);
  }
}

TEST_CASE("A front-end gets no event outside its camera, whatever size a source states") {
  class OtherSource : public Source {
   public:
    explicit OtherSource(Camera camera, StreamInfo info) : camera_(std::move(camera)), info_(std::move(info)) {}
    const Camera& camera() const override { return camera_; }
    TimeRange time_range() const override { return {0.0, 2.0}; }
    const PoseTrajectory& ground_truth() const override { return truth_; }
    bool is_lenient() const override { return true; }
    std::unique_ptr<EventReader> all_events() const override {
      class Reader : public EventReader {
       public:
        explicit Reader(StreamInfo info) : info_(std::move(info)) {}
        const StreamInfo& info() const override { return info_; }
        bool read(std::vector<Event>& events) override {
          events.clear();
          if (!done_) events = {{1, 5, 5, true}, kCorner};
          done_ = true;
          return !events.empty();
        }
        void seek(std::int64_t) override { done_ = false; }
        const Faults& faults() const override { return faults_; }

       private:
        StreamInfo info_;
        Faults faults_{"", false};
        bool done_ = false;
      };
      return std::make_unique<Reader>(info_);
    }

   private:
    Camera camera_;
    StreamInfo info_;
    PoseTrajectory truth_;
  };
  Camera camera;
  camera.width = 240;
  camera.height = 180;
  CHECK(events_given_by(OtherSource(camera, {})).size() == 1);
  StreamInfo larger;
  larger.width = 346;
  larger.height = 260;
  CHECK_THROWS_WITH(events_given_by(OtherSource(camera, larger)),
                    ContainsSubstring("240x180") && ContainsSubstring("346x260"));
  CHECK_THROWS_WITH(events_given_by(OtherSource({}, larger)), ContainsSubstring("has no sensor size"));
}

TEST_CASE("A bag that says its sensor's size runs with a text calibration, as its messages have it") {
  const auto path = testing::data_file("cases/sensor_size/davis346.bag");
  if (!path) return;
  const std::string folder = path->substr(0, path->rfind('/'));
  const Recording source(evbench::read_options<Recording::Options>(
                             parse_json(R"({"events": "davis346.bag", "calibration": "calib346.txt"})"), "config"),
                         {0, folder});
  CHECK(source.camera().width == 346);
  CHECK(source.camera().height == 260);
  CHECK(events_given_by(source).size() == 200'000);
}
