#include "core/data/tracks.hpp"

#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

TrackFile tracks(const std::string& content) {
  const testing::TemporaryFolder folder;
  return read_tracks(folder.write("tracks.txt", content), 240, 180, {0.5});
}

}  // namespace

TEST_CASE("Tracks are sorted by time, then by id, and anomalies are counted") {
  const TrackFile file = tracks("7 0.2 1 1\n3 0.2 2 2\n7 0.1 3 3\n7 0.2 9 9\n3 0.3 240 10\n5 0.1 4 4\n");
  REQUIRE(file.observations.size() == 5);
  CHECK(file.observations[0].track == 5);
  CHECK(file.observations[1].track == 7);
  CHECK(file.observations[2].track == 3);
  CHECK(file.observations[3].pixel == Vector2(1, 1));
  CHECK(file.observations[3].noise == 0.5);
  CHECK(file.report.records == 6);
  CHECK(file.report.tracks == 3);
  CHECK(file.report.unordered == 1);
  CHECK(file.report.duplicates == 1);
  CHECK(file.report.outside == 1);
  CHECK(file.report.single_observation == 1);
}

TEST_CASE("A file with one track after the other is not counted as unordered") {
  CHECK(tracks("1 0.1 1 1\n1 0.2 1 1\n2 0.1 1 1\n2 0.2 1 1\n").report.unordered == 0);
}

TEST_CASE("A track file reads back exactly as written") {
  const testing::TemporaryFolder folder;
  const std::vector<TrackObservation> written = {{4, 0.1 + 0.2, {1.0 / 3.0, 100.123456789}, 1.0},
                                                 {-2, 7.0, {0, 1}, 1.0}};
  write_file(folder.file("tracks.txt"), format_tracks(written));
  const auto read = read_tracks(folder.file("tracks.txt"), 240, 180).observations;
  REQUIRE(read.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(read[i].track == written[i].track);
    CHECK(read[i].t == written[i].t);
    CHECK(read[i].pixel == written[i].pixel);
  }
}

TEST_CASE("A damaged track file is refused with its line and fault") {
  CHECK_THROWS_AS(tracks(""), InputError);
  CHECK_THROWS_WITH(tracks(""), ContainsSubstring("holds no observation"));
  CHECK_THROWS_WITH(tracks("1 0.1 1 1\n1 0.2 1\n"), ContainsSubstring("tracks.txt:2: has 3 columns; expected 4"));
  CHECK_THROWS_WITH(tracks("1.5 0.1 1 1\n"), ContainsSubstring("tracks.txt:1: the id is \"1.5\""));
  CHECK_THROWS_WITH(tracks("1 nan 1 1\n"), ContainsSubstring("the time is \"nan\""));
  CHECK_THROWS_WITH(tracks("1 0.1 inf 1\n"), ContainsSubstring("x is \"inf\""));
  CHECK_THROWS_WITH(read_tracks("/no/such/file", 240, 180), ContainsSubstring("no such file"));
}

TEST_CASE("Track columns are those requested, those named in the file, or those of EKLT and HASTE") {
  const auto same = [](const TrackFile& file) {
    REQUIRE(file.observations.size() == 2);
    CHECK(file.observations[0].track == 7);
    CHECK(file.observations[0].t == 0.5);
    CHECK(file.observations[1].pixel == Vector2(12, 21));
  };
  same(tracks("7 0.5 10 20\n7 0.6 12 21\n"));
  same(tracks("7,0.5,10,20\n7,0.6,12,21\n"));
  same(tracks("# comment\n7\t0.5\t10\t20\n7;0.6;12;21\n"));
  same(tracks("# feature_id timestamp x y\n7 0.5 10 20\n7 0.6 12 21\n"));
  same(tracks("x,y,score,track_id,t_us\n10,20,0,7,500000\n12,21,0,7,600000\n"));
  same(tracks("7,0.5,10,20,0.1\n7,0.6,12,21,0.2\n"));
  const TrackFile haste = tracks("0.500000,10.000000,20.000000,0.000000,7\n0.600000,12.000000,21.000000,0.1,7\n");
  same(haste);
  CHECK_THAT(haste.assumption, ContainsSubstring("tracks.txt: read with columns t x y - id, times in seconds"));
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("tracks.txt", "frame,feature,when,where\n1,0.5,10,20,7\n2,0.6,12,21,7\n");
  same(read_tracks(path, 240, 180, {.columns = "- t x y id"}));
  CHECK_THROWS_WITH(read_tracks(path, 240, 180),
                    ContainsSubstring("tracks.txt:1: names the columns") && ContainsSubstring("id t x y"));
  CHECK_THROWS_WITH(read_tracks(path, 240, 180, {.columns = "t x y"}), ContainsSubstring("expected id, t, x and y"));
  CHECK(tracks("7 0.5 10 20\n").assumption.empty());
}

TEST_CASE("The real tracks of poster_translation read whole") {
  const auto path = testing::data_file("poster_translation/tracks_eklt.txt");
  if (!path) return;
  const TrackFile file = read_tracks(*path, 240, 180);
  CHECK(file.report.records == 66331);
  CHECK(file.report.tracks == 80);
  CHECK(file.report.outside == 123);
}
