#include "bench/pipeline/batch_recording.hpp"

#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

namespace {

class ThreeBatches : public BatchStream {
 public:
  std::optional<TrackBatch> next() override {
    if (count_ == 3) return std::nullopt;
    TrackBatch batch;
    batch.until = 0.1 * ++count_;
    batch.seen = batch.until + 1e-17 + 0.03;
    for (int i = 0; i < count_ - 1; ++i) batch.observations.push_back({7 - i, 0.1 / 3.0 + i, {1.0 / 3.0, -2.5}, 0.7});
    if (count_ == 2) batch.ended.push_back({-1, 0.15});
    return batch;
  }
  FrontFacts facts() const override {
    return {0.1, 1.0 / 3.0, {{1.0, 0.1}, {2.0, 0.7}}, 2.0, {"source: x", "frontend: \xff"}};
  }
  double spent() const override { return 0.0; }

 private:
  int count_ = 0;
};

}  // namespace

TEST_CASE("A recording replays the same batches, bit by bit, and the facts of the recorded front-end") {
  const testing::TemporaryFolder folder;
  ThreeBatches recorded, again;
  const auto played = RecordedBatches::open(folder.write("batches", record_batches(recorded)));
  REQUIRE(played);
  while (const auto expected = again.next()) {
    const auto batch = played->next();
    REQUIRE(batch);
    CHECK(batch->until == expected->until);
    CHECK(batch->seen == expected->seen);
    REQUIRE(batch->observations.size() == expected->observations.size());
    for (std::size_t i = 0; i < batch->observations.size(); ++i) {
      const TrackObservation &a = batch->observations[i], &b = expected->observations[i];
      CHECK((a.track == b.track && a.t == b.t && a.pixel == b.pixel && a.noise == b.noise));
    }
    REQUIRE(batch->ended.size() == expected->ended.size());
    for (std::size_t i = 0; i < batch->ended.size(); ++i) {
      CHECK((batch->ended[i].track == expected->ended[i].track && batch->ended[i].t == expected->ended[i].t));
    }
  }
  CHECK_FALSE(played->next());
  const FrontFacts facts = played->facts();
  CHECK(facts.source_s == 0.1);
  CHECK(facts.frontend_s == 1.0 / 3.0);
  CHECK(facts.work == std::vector<Work>{{1.0, 0.1}, {2.0, 0.7}});
  CHECK(facts.data_s == 2.0);
  CHECK(facts.log.at(0) == "source: x");
  CHECK(facts.log.size() == 2);
}

TEST_CASE("A recording that is missing, truncated or changed is not opened") {
  const testing::TemporaryFolder folder;
  ThreeBatches recorded;
  const std::string bytes = record_batches(recorded);
  CHECK_FALSE(RecordedBatches::open(folder.file("none")));
  CHECK_FALSE(RecordedBatches::open(folder.write("empty", "")));
  for (std::size_t size = 1; size < bytes.size(); size += 7) {
    CHECK_FALSE(RecordedBatches::open(folder.write("short", bytes.substr(0, size))));
  }
  std::string changed = bytes;
  changed[30] = static_cast<char>(changed[30] ^ 1);
  CHECK_FALSE(RecordedBatches::open(folder.write("changed", changed)));
}
