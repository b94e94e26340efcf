#include "eval/old_names.hpp"

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

TEST_CASE("Old names of options are read, each with a remark, in one back-end and in a list of them") {
  Json one = parse_json(R"({"backend": {"type": "bundle_adjustment", "frame_duration": 0.1, "window": 5},
                            "pipeline": {"still_after": 0.2}})");
  const std::vector<std::string> remarks = rename_old_keys(one);
  CHECK(one == parse_json(R"({"backend": {"type": "bundle_adjustment", "window": 5, "batch_duration": 0.1},
                              "pipeline": {"stationary_after": 0.2}})"));
  REQUIRE(remarks.size() == 2);
  CHECK(remarks[0] ==
        "backend.frame_duration is called batch_duration now; the old name is read until the next version");

  Json list = parse_json(R"({"backends": [{"type": "bundle_adjustment", "frame_motion": 3},
                                          {"type": "gp_map", "learn": {"prior": "hindsight"}}]})");
  CHECK(rename_old_keys(list).size() == 2);
  CHECK(list == parse_json(R"({"backends": [{"type": "bundle_adjustment", "batch_motion": 3},
                                            {"type": "gp_map", "learn": {"prior": "smoothed"}}]})"));
  CHECK(rename_old_keys(list).empty());

  Json groups = parse_json(R"({"backend": {"type": "gp_map", "map": {"returns": 5, "patience": 1},
                                           "outliers": {"threshold": 2}}})");
  CHECK(rename_old_keys(groups) == std::vector<std::string>{"backend.map.returns is called reassociation.returns now; "
                                                            "the old name is read until the next version"});
  CHECK(groups == parse_json(R"({"backend": {"type": "gp_map", "map": {"patience": 1}, "outliers": {"threshold": 2},
                                             "reassociation": {"returns": 5}}})"));
}

TEST_CASE("An old name is not renamed for another plugin, nor if the present name also exists") {
  const Json other = parse_json(R"({"backend": {"type": "mine", "frame_duration": 0.1}})");
  const Json both =
      parse_json(R"({"backend": {"type": "bundle_adjustment", "frame_duration": 0.1, "batch_duration": 0.2}})");
  for (const Json& config : {other, both}) {
    Json renamed = config;
    CHECK(rename_old_keys(renamed).empty());
    CHECK(renamed == config);
  }
}

TEST_CASE("Metrics and files of a run of an older version are found by their present names") {
  Json metrics = parse_json(R"({"final": {}, "online": {"pairs": 3}, "status": {"still": [1], "pieces": [2],
                                "scored_piece": 1}})");
  rename_old_metrics(metrics);
  CHECK(metrics == parse_json(R"({"final": {}, "status": {"stationary": [1], "segments": [2], "scored_segment": 1},
                                  "causal": {"pairs": 3}})"));
  CHECK(present_metric("online.ate.trans_m.rmse") == "causal.ate.trans_m.rmse");
  CHECK(present_metric("final.ate.trans_m.rmse") == "final.ate.trans_m.rmse");

  const testing::TemporaryFolder folder;
  folder.write("told.txt", "");
  CHECK(file_of_run(folder.path(), "causal_poses.txt") == folder.file("told.txt"));
  folder.write("causal_poses.txt", "");
  CHECK(file_of_run(folder.path(), "causal_poses.txt") == folder.file("causal_poses.txt"));
  CHECK(file_of_run(folder.path(), "final.tum") == folder.file("final.tum"));
}
