#include <fmt/format.h>

#include "core/events/event_stream.hpp"
#include "core/events/testing/bag_writer.hpp"
#include "core/events/testing/recordings.hpp"
#include "core/support/index.hpp"

using namespace evbench;
using namespace evbench::testing::bag_writer;

namespace {

constexpr std::int64_t kMs = 1'000'000;  // [ns]
const BagConnection kDvs{"/dvs/events", "dvs_msgs/EventArray"};

/// A message of ten events at each of some times [ms], by connection 0 or 1 in turn.
std::vector<BagMessage> events_at(std::initializer_list<int> times) {
  std::vector<BagMessage> messages;
  for (const int t : times) {
    messages.push_back(
        {static_cast<std::uint32_t>(t % 2), 1000 * kMs + kMs * t, event_array(1000 * kMs + kMs * t, 10)});
  }
  return messages;
}

/// Twelve messages, in chunks out of order that overlap.
std::vector<std::vector<BagMessage>> disorder() {
  return {events_at({3, 4, 6}), events_at({1, 0, 2}), events_at({9, 10, 11}), events_at({5, 8, 7})};
}

std::size_t good_events(const std::string& path) {
  EventStream stream(path, {.read = {.lenient = true}});
  std::size_t count = 0;
  for (std::vector<Event> events; stream.read(events);) count += events.size();
  return count;
}

}  // namespace

TEST_CASE(
    "A bag's events are read in the order of their log times, of all connections of the topic, with an index or "
    "without") {
  const bool indexed = GENERATE(true, false);
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("a.bag", bag_of({kDvs, kDvs}, disorder(), indexed));
  EventStream stream(path);
  std::vector<Event> all;
  for (std::vector<Event> events; stream.read(events);) all.insert(all.end(), events.begin(), events.end());
  CHECK(all.size() == 120);
  CHECK(stream.faults().size() == (indexed ? 0 : 1));
  CHECK(stream.info().topics == std::vector<std::string>{"/dvs/events (dvs_msgs/EventArray), 12 messages"});
  testing::check_seeking(path);
}

TEST_CASE("An index that lies is counted, and what it does not name is read") {
  const testing::TemporaryFolder folder;
  const auto read = [&](const std::function<void(std::vector<BagIndexEntry>&)>& lie) {
    const auto reader = open_events(folder.write("a.bag", bag_of({kDvs, kDvs}, disorder(), true, lie)));
    const std::size_t count = testing::read_all(*reader).size();
    std::string faults;
    for (const auto& [kind, fault] : reader->faults().all()) faults += fmt::format("{} {}\n", fault.count, kind);
    reader->seek(0);
    CHECK(testing::read_all(*reader).size() == count);
    return std::make_pair(count, faults);
  };
  CHECK(read([](auto& index) { index[1].offset += 7; }) ==
        std::make_pair(std::size_t{120}, std::string("1 chunks that are not where the index says\n"
                                                     "1 chunks that the index does not name\n")));
  CHECK(read([](auto& index) { index[2].offset = 0; }) ==
        std::make_pair(std::size_t{120}, std::string("1 chunks that the index does not name\n")));
  CHECK(read([](auto& index) { index[2].offset = index[1].offset; }) ==
        std::make_pair(std::size_t{120}, std::string("1 no index: the bag was not closed, or is cut short\n")));
  CHECK(read([](auto& index) { index[3].offset = std::uint64_t{1} << 63; }).first == 120);
  CHECK(read([](auto& index) { index[1].start = index[1].end = 5000 * kMs; }) ==
        std::make_pair(std::size_t{120}, std::string("1 chunks with messages of other times than the index says\n")));
}

TEST_CASE("Behind a broken record a bag is read on from the next chunk of its index") {
  const testing::TemporaryFolder folder;
  std::uint64_t second = 0;
  std::string bag = bag_of({kDvs, kDvs}, disorder(), true, [&](const auto& index) { second = index[1].offset; });
  bag.replace(second, 4, "\xFF\xFF\xFF\xFF");
  const auto reader = open_events(folder.write("a.bag", bag));
  CHECK(testing::read_all(*reader).size() == 90);
  CHECK(reader->faults().all().contains("broken records, behind which reading goes on with the next chunk"));
}

TEST_CASE("Bags with two connections of a topic, and with chunks out of order, broken anywhere are never a crash") {
  testing::check_survives(bag_of({kDvs, kDvs}, {events_at({1, 0, 2}), events_at({3}), events_at({6, 5, 4})}),
                          [folder = std::make_shared<testing::TemporaryFolder>()](const std::string& content) {
                            return open_events(folder->write("broken.bag", content));
                          });
}

TEST_CASE("Poses and camera infos are those of all connections of their topics, poses in the order of their stamps") {
  const BagConnection poses{"/pose", "geometry_msgs/PoseStamped"}, info{"/dvs/camera_info", "sensor_msgs/CameraInfo"};
  std::vector<BagMessage> messages;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t t = 1000 * kMs + i * kMs;
    messages.push_back({0, t, event_array(t, 5)});
    // The second publisher's poses arrive late.
    messages.push_back({i % 5 < 3 ? 1u : 2u, i % 5 < 3 ? t : t + 4 * kMs, pose_stamped(t, i)});
  }
  messages.push_back({4, 1200 * kMs, camera_info(240, 180)});
  const testing::TemporaryFolder folder;
  const auto reader = open_events(folder.write("a.bag", bag_of({kDvs, poses, poses, info, info}, {messages})));
  const auto truth = reader->ground_truth();
  REQUIRE(truth);
  REQUIRE(truth->size() == 100);
  for (int i = 0; i < 100; ++i) CHECK(truth->poses()[index(i)].T.p.x() == i);
  CHECK(reader->faults().empty());
  const auto camera = reader->calibration();
  REQUIRE(camera);
  CHECK(camera->pinhole.fx == 199.0);
}

TEST_CASE("Bags from bug reports: two publishers, chunks out of the order of time") {
  for (const char* name : {"cases/two_connections/two_publishers.bag", "cases/two_connections/one_publisher.bag",
                           "cases/file_order/neighbours.bag"}) {
    CAPTURE(name);
    if (const auto path = testing::data_file(name)) CHECK(good_events(*path) == 5000);
  }
}
