#include "bench/testing/program.hpp"
#include "core/events/testing/data_sets.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("Folders of public data sets are described, converted and drawn, and can be named in a config", "[long]") {
  const testing::TemporaryFolder folder;
  if (!testing::write_data_sets(folder)) return;
  const std::string set =
      GENERATE("dsec/seq", "dsec/nested", "tumvie/mocap-desk", "m3ed/falcon", "mvsec/flying1", "eds/peanuts");
  CAPTURE(set);
  const testing::Outcome info = testing::evbench(folder, "info --quiet " + set);
  CHECK(info.exit_code == 0);
  CHECK_THAT(info.out, ContainsSubstring("events        100: 50 on, 50 off"));
  CHECK_THAT(info.out, ContainsSubstring("calibration   fx "));
  CHECK((info.out.find("ground truth  none") != std::string::npos) == set.starts_with("dsec"));
  CHECK(testing::evbench(folder, "render " + set + " a.png").exit_code == 0);
  CHECK(testing::evbench(folder, "convert " + set + " " + set + "/events.evb").exit_code == 0);
  CHECK_THAT(testing::evbench(folder, "info --quiet " + set).out, ContainsSubstring("evbench native"));
  folder.write("a.json", R"({"source": {"type": "recording", "dataset": ")" + set + "\"}}");
  const testing::Outcome named =
      testing::shell(folder, "EVBENCH_DATASETS='" + folder.path() + "' \"$evbench\" info --quiet a.json");
  CHECK(named.exit_code == 0);
  CHECK_THAT(named.out, ContainsSubstring("calibration   fx "));
}

TEST_CASE("Assumptions on a recording's ground truth file are remarks on the recording, which a native copy keeps",
          "[slow]") {
  const testing::TemporaryFolder folder;
  folder.write("events.txt", "0.1 5 6 1\n0.2 7 8 0\n");
  folder.write("groundtruth.txt", "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n100000000,1,2,3,1,0,0,0\n");
  const std::string remark = "remark: ./groundtruth.txt: read with columns t px py pz qw qx qy qz (as they are named)";
  const testing::Outcome info = testing::evbench(folder, "info --quiet .");
  CHECK_THAT(info.out, ContainsSubstring("1 poses, 0.100 to 0.100 s") && ContainsSubstring(remark));
  REQUIRE(testing::evbench(folder, "convert . copy.evb --width 10 --height 10").exit_code == 0);
  CHECK_THAT(testing::evbench(folder, "info --quiet copy.evb").out, ContainsSubstring(remark));
}

TEST_CASE("A recording whose calibration or ground truth cannot be used is described all the same, but not strictly",
          "[slow]") {
  const testing::TemporaryFolder folder;
  folder.write("events.txt", "0.1 5 6 1\n0.2 7 8 0\n");
  folder.write("calib.txt", "no numbers\n");
  folder.write("groundtruth.txt", "no poses\n");
  const testing::Outcome info = testing::evbench(folder, "info --quiet .");
  CHECK(info.exit_code == 0);
  CHECK_THAT(info.out, ContainsSubstring("events        2: 1 on, 1 off"));
  CHECK_THAT(info.out, ContainsSubstring("calibration that cannot be used: ./calib.txt:1: has 2 columns"));
  CHECK_THAT(info.out, ContainsSubstring(
                           "ground truth that cannot be used: ./groundtruth.txt:1: names the columns \"no poses\""));
  CHECK_THAT(info.out, ContainsSubstring("calibration   cannot be used, see below"));
  const testing::Outcome convert = testing::evbench(folder, "convert . copy.txt");
  CHECK(convert.exit_code == 0);
  CHECK_THAT(convert.out, ContainsSubstring("left out: calibration that cannot be used: ./calib.txt:1") &&
                              ContainsSubstring("left out: ground truth that cannot be used") &&
                              ContainsSubstring("2 events"));
  CHECK(testing::evbench(folder, "convert --strict . strict.txt").exit_code == 2);
  const testing::Outcome strict = testing::evbench(folder, "info --quiet --strict .");
  CHECK(strict.exit_code == 2);
  CHECK_THAT(strict.err, ContainsSubstring("./calib.txt:1: has 2 columns"));
}
