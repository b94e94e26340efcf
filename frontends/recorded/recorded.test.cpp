#include "frontends/recorded/recorded.hpp"

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

class FakeSource : public Source {
 public:
  explicit FakeSource(TimeRange range) : range_(range) {
    camera_.width = 240;
    camera_.height = 180;
  }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return range_; }
  const PoseTrajectory& ground_truth() const override { return trajectory_; }

 private:
  Camera camera_;
  TimeRange range_;
  PoseTrajectory trajectory_;
};

std::vector<TrackObservation> all(FrontEnd& frontend) {
  TrackBatch batch;
  frontend.advance({1e9}, batch);
  return batch.observations;
}

// Track 1: unordered and with a duplicate; track 2: a single observation; track 3: leaves the image, and goes on after
// 1 s.
const char* const kTracks =
    "1 0.3 10 10\n1 0.1 10 10\n1 0.3 99 99\n2 0.2 20 20\n3 0.4 30 30\n3 0.5 -1 30\n3 0.6 31 30\n3 1.5 32 30\n";

Recorded open(const std::string& options, const testing::TemporaryFolder& folder, const Source& source) {
  return Recorded(read_options<Recorded::Options>(parse_json(options), "config"), {source, 0, folder.path()});
}

}  // namespace

TEST_CASE("Recorded tracks come in time order within the source's time range, and oddities are reported") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", kTracks);
  const FakeSource source({0.0, 1.0});
  Recorded frontend = open(R"({"tracks": "tracks.txt", "sigma": 0.7})", folder, source);
  const std::vector<TrackObservation> observations = all(frontend);
  REQUIRE(observations.size() == 5);
  CHECK(observations[0].t == 0.1);
  CHECK(observations[2].pixel == Vector2(10, 10));
  CHECK(observations[4].t == 0.6);
  CHECK(observations[0].noise == 0.7);
  std::string remarks;
  for (const std::string& remark : frontend.remarks()) remarks += remark + "\n";
  CHECK_THAT(remarks, ContainsSubstring("8 observations of 3 tracks") &&
                          ContainsSubstring("1 observations out of order") &&
                          ContainsSubstring("1 observations with the track and time of another") &&
                          ContainsSubstring("1 observations outside the image (dropped)") &&
                          ContainsSubstring("1 tracks with a single observation") &&
                          ContainsSubstring("1 observations outside 0 to 1 s"));
}

TEST_CASE("Recorded tracks are given up to the time asked for, each once") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", kTracks);
  const FakeSource source({0.0, 2.0});
  Recorded frontend = open(R"({"tracks": "tracks.txt"})", folder, source);
  TrackBatch batch;
  CHECK(frontend.advance({0.3}, batch));
  CHECK(batch.observations.size() == 3);
  REQUIRE(batch.ended.size() == 2);  // 2, seen once, and 1
  CHECK(batch.ended[0].track == 2);
  CHECK(batch.ended[1].track == 1);
  CHECK_FALSE(frontend.advance({2.0}, batch));
  CHECK(batch.observations.size() == 3);
  CHECK(batch.ended.at(0).track == 3);
}

TEST_CASE("Observations outside the image are kept on request, short tracks are left out") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", kTracks);
  const FakeSource source({0.0, 1.0});
  Recorded frontend = open(R"({"tracks": "tracks.txt", "outside": "keep", "min_track_length": 3})", folder, source);
  const std::vector<TrackObservation> observations = all(frontend);
  REQUIRE(observations.size() == 3);
  CHECK(observations[1].pixel == Vector2(-1, 30));
}

TEST_CASE("Recorded tracks end where a file says so, and may go on") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", "1 0.1 10 10\n1 0.5 12 10\n2 0.2 20 20\n");
  folder.write("ends.txt", "2 0.7\n1 0.3\n");
  const FakeSource source({0.0, 1.0});
  Recorded frontend = open(R"({"tracks": "tracks.txt", "ends": "ends.txt"})", folder, source);
  TrackBatch batch;
  frontend.advance({0.4}, batch);
  REQUIRE(batch.ended.size() == 1);
  CHECK(batch.ended[0].track == 1);
  CHECK(batch.ended[0].t == 0.3);
  folder.write("ends.txt", "");
  Recorded endless = open(R"({"tracks": "tracks.txt", "ends": "ends.txt"})", folder, source);
  endless.advance({0.4}, batch);
  REQUIRE(batch.ended.size() == 1);
  CHECK(batch.ended[0].track == 2);  // with its last observation
  folder.write("ends.txt", "2 0.7\n1\n");
  CHECK_THROWS_WITH(open(R"({"tracks": "tracks.txt", "ends": "ends.txt"})", folder, source),
                    ContainsSubstring("ends.txt:2") && ContainsSubstring("id t"));
  CHECK_THROWS_WITH(open(R"({"tracks": "tracks.txt", "ends": "no.txt"})", folder, source),
                    ContainsSubstring("no such file"));
}

TEST_CASE("Recorded tracks that are missing, or of another time, are refused") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", kTracks);
  const FakeSource source({5.0, 6.0});
  CHECK_THROWS_WITH(open(R"({"tracks": "no.txt"})", folder, source), ContainsSubstring("no such file"));
  CHECK_THROWS_WITH(open(R"({"tracks": "tracks.txt"})", folder, source), ContainsSubstring("no observation is left"));
  CHECK_THROWS_WITH(open("{}", folder, source), ContainsSubstring("\"tracks\" is missing"));
}

TEST_CASE("Tracks in another unit of time are diagnosed, and read when it is stated") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.txt", "1 100000 10 10\n1 900000 11 10\n");
  const FakeSource source({0.0, 1.0});
  CHECK_THROWS_WITH(
      open(R"({"tracks": "tracks.txt"})", folder, source),
      ContainsSubstring("between 0 and 1 s, the source's time range: times go from 100000 to 900000 s; in microseconds "
                        "(time_unit: us) they would go from 0.1 to 0.9 s"));
  Recorded frontend = open(R"({"tracks": "tracks.txt", "time_unit": "us"})", folder, source);
  CHECK(all(frontend).at(0).t == 0.1);
  CHECK_THAT(frontend.remarks().at(1), ContainsSubstring("times in microseconds"));
}

TEST_CASE("Tracks in other columns are read as they are named") {
  const testing::TemporaryFolder folder;
  folder.write("tracks.csv", "0.1,10,12,0,5\n0.2,11,12,0,5\n");
  const FakeSource source({0.0, 1.0});
  Recorded frontend = open(R"({"tracks": "tracks.csv", "columns": "t x y theta id"})", folder, source);
  CHECK(all(frontend).at(1).pixel == Vector2(11, 12));
}

TEST_CASE("The real tracks of poster_translation are read whole") {
  const auto path = testing::data_file("poster_translation/tracks_eklt.txt");
  if (!path) return;
  const FakeSource source({0.0, 10.0});
  Recorded frontend({.tracks = *path, .outside = "keep"}, {source, 0, ""});
  CHECK(all(frontend).size() == 66331);
}
