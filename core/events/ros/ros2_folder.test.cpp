#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "core/events/testing/mcap_writer.hpp"
#include "core/events/testing/recordings.hpp"
#include "core/support/index.hpp"
#include "core/support/interruption.hpp"

using namespace evbench;
using namespace evbench::testing::mcap_writer;

namespace {

constexpr int kPackets = 60;  ///< of one event each, 50 ms apart

std::uint64_t recorded(int i) { return 7'001'000'000 + 50'000'000 * static_cast<std::uint64_t>(i); }  // [ns]

/// A packet of one libcaer event in CDR.
std::string cdr_packet(int i) {
  const auto padded = [](std::string fields, std::size_t unit) {
    fields.resize((fields.size() + unit - 1) / unit * unit);
    return fields;
  };
  const auto string = [](const std::string& characters) { return text(characters + '\0'); };
  std::string fields = bytes<std::uint32_t>(7) + bytes<std::uint32_t>(0) + string("camera");
  fields = padded(fields, 4) + bytes<std::uint32_t>(260) + bytes<std::uint32_t>(346);
  fields = padded(fields, 8) + bytes<std::uint64_t>(0) + bytes<std::uint64_t>(7'000'000'000) + string("libcaer");
  fields = padded(fields + '\0', 4) +
           text(bytes<std::uint32_t>(3u << 17 | 4u << 2 | 3u) + bytes(static_cast<std::uint32_t>(50'000 * i)));
  return std::string("\0\1\0\0", 4) + fields;
}

std::string compressed(const std::string& content) {
  std::string packed(ZSTD_compressBound(content.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), content.data(), content.size(), 1));
  return packed;
}

/// With an MCAP file's messages first to last.
std::string mcap_of(int first, int last) {
  std::string records;
  for (int i = first; i < last; ++i) records += message(9, recorded(i), cdr_packet(i));
  return mcap(chunk("lz4", topics("cdr") + records));
}

/// Written by Python's sqlite3, in the layout of rosbag2_storage_sqlite3. `order`: of the messages in the file; two
/// rows of the table of topics share them.
std::string sqlite_of(const testing::TemporaryFolder& folder, const std::vector<int>& order, bool packed) {
  std::string rows;
  for (const int i : order) {
    rows += fmt::format("{} ", recorded(i));
    for (const char c : packed ? compressed(cdr_packet(i)) : cdr_packet(i)) {
      rows += fmt::format("{:02x}", static_cast<unsigned char>(c));
    }
    rows += '\n';
  }
  const std::string script = folder.write("write.py", R"py(
import sqlite3, sys
db = sqlite3.connect(sys.argv[1])
db.execute('CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, qos TEXT)')
db.execute('CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)')
db.execute('CREATE INDEX timestamp_idx ON messages (timestamp ASC)')
for topic in (4, '/imu', 'sensor_msgs/msg/Imu'), (5, '/events', 'event_camera_msgs/msg/EventPacket'), (6, '/events', 'event_camera_msgs/msg/EventPacket'):
    db.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", topic)
for i, line in enumerate(open(sys.argv[2])):
    t, data = line.split()
    row = 5 + i % 2, int(t), bytes.fromhex(data)
    db.execute('INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)', row)
db.commit()
)py");
  const std::string path = folder.file("written.db3");
  std::filesystem::remove(path);
  const std::string arguments = script + " " + path + " " + folder.write("rows.txt", rows);
  REQUIRE(std::system(("/usr/bin/python3 " + arguments).c_str()) == 0);
  return testing::read_file(path);
}

std::string sqlite_of(const testing::TemporaryFolder& folder, int first, int last, bool packed) {
  std::vector<int> order(index(last - first));
  std::iota(order.begin(), order.end(), first);
  return sqlite_of(folder, order, packed);
}

/// As rosbag2 writes it.
std::string metadata(const std::vector<std::string>& names, const std::string& compression_mode = "",
                     bool with_times = true) {
  std::string files, paths;
  const auto each = kPackets / static_cast<int>(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    paths += "    - recording/" + names[i] + "\n";
    files += fmt::format(
        "    - path: {}\n      starting_time:\n        nanoseconds_since_epoch: {}\n      duration:\n"
        "        nanoseconds: {}\n      message_count: {}\n",
        names[i], recorded(static_cast<int>(i) * each), std::int64_t{50'000'000} * (each - 1), each);
  }
  return fmt::format(
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  message_count: {}\n"
      "  topics_with_message_count:\n    - topic_metadata:\n        name: /events\n"
      "        type: event_camera_msgs/msg/EventPacket\n        serialization_format: cdr\n"
      "        offered_qos_profiles: \"- history: 3\"\n      message_count: {}\n"
      "  compression_format: \"{}\"\n  compression_mode: \"{}\"\n  relative_file_paths:\n{}{}",
      kPackets, kPackets, compression_mode.empty() ? "" : "zstd", compression_mode, paths,
      with_times ? "  files:\n" + files : "");
}

void check_events(EventReader& reader, int first = 0) {
  const auto events = testing::read_all(reader);
  REQUIRE(static_cast<int>(events.size()) == kPackets - first);
  for (int i = first; i < kPackets; ++i) {
    CHECK(events[index(i - first)] == Event{7'000'000 + 50'000 * i, 3, 4, true});
  }
}

/// Two MCAP files of a recording with their metadata.
void write_recording(const testing::TemporaryFolder& folder) {
  folder.write("metadata.yaml", metadata({"a_0.mcap", "a_1.mcap"}));
  folder.write("a_0.mcap", mcap_of(0, kPackets / 2));
  folder.write("a_1.mcap", mcap_of(kPackets / 2, kPackets));
}

/// While one lives, temporary files are made in a folder.
class TemporaryFilesIn {
 public:
  explicit TemporaryFilesIn(const std::string& folder) : before_(std::filesystem::temp_directory_path()) {
    ::setenv("TMPDIR", folder.c_str(), 1);
  }
  ~TemporaryFilesIn() { ::setenv("TMPDIR", before_.c_str(), 1); }

 private:
  std::string before_;
};

}  // namespace

TEST_CASE("A ROS 2 recording of several files is read, sought and described as one, whatever its files") {
  const std::string kind = GENERATE("sqlite", "sqlite, files compressed", "sqlite, messages compressed", "mcap",
                                    "mcap, files compressed", "mcap, no times");
  CAPTURE(kind);
  const bool sqlite = kind.starts_with("sqlite"), packed_files = kind.ends_with("files compressed"),
             packed_messages = kind.ends_with("messages compressed");
  const testing::TemporaryFolder folder, others;
  std::vector<std::string> names;
  for (int i = 0; i < 3; ++i) {
    const int first = kPackets / 3 * i, last = kPackets / 3 * (i + 1);
    const std::string content = sqlite ? sqlite_of(others, first, last, packed_messages) : mcap_of(first, last);
    names.push_back(fmt::format("a_{}.{}{}", i, sqlite ? "db3" : "mcap", packed_files ? ".zstd" : ""));
    folder.write(names.back(), packed_files ? compressed(content) : content);
  }
  folder.write("metadata.yaml", metadata(names,
                                         packed_files      ? "FILE"
                                         : packed_messages ? "MESSAGE"
                                                           : "",
                                         kind != "mcap, no times"));
  const auto reader = open_events(folder.path());
  CHECK(reader->info().format == "ROS 2 recording");
  CHECK(reader->info().width == 346);
  CHECK(reader->info().start == 7'000'000);
  CHECK(reader->info().topics == std::vector<std::string>{"/events (event_camera_msgs/EventPacket), 60 messages"});
  check_events(*reader);
  testing::check_seeking(folder.path());
  if (sqlite) {
    CHECK(reader->faults().empty());
    reader->seek(7'000'000 + 50'000 * 45);
    CHECK(testing::read_all(*reader).size() < 20);  // the files before the third aren't read
  }
}

TEST_CASE("A ROS 2 bag in SQLite is read in the order of its timestamps, with an index of them or without") {
  const testing::TemporaryFolder folder;
  std::vector<int> order(kPackets);
  for (int i = 0; i < kPackets; ++i) order[index(i)] = i * 7 % kPackets;
  const std::string path = folder.write("a.db3", sqlite_of(folder, order, false));
  if (GENERATE(false, true)) {
    REQUIRE(std::system(("/usr/bin/python3 -c \"import sqlite3; sqlite3.connect('" + path +
                         "').execute('DROP INDEX timestamp_idx')\"")
                            .c_str()) == 0);
  }
  const auto reader = open_events(path);
  check_events(*reader);
  CHECK(reader->info().topics.back() == "/events (event_camera_msgs/EventPacket), 60 messages");
  testing::check_seeking(path);
}

TEST_CASE("A compressed file of a ROS 2 recording is unpacked once, and leaves nothing in the temporary folder") {
  const bool sqlite = GENERATE(false, true);
  const testing::TemporaryFolder folder, others;
  const TemporaryFilesIn temporary(others.path());
  const std::string content = sqlite ? sqlite_of(folder, 0, kPackets, false) : mcap_of(0, kPackets);
  const std::string path = folder.write("a_0.zstd", compressed(content));
  folder.write("metadata.yaml", metadata({"a_0.zstd"}, "FILE"));
  const auto reader = open_events(folder.path());
  CHECK(std::filesystem::is_empty(others.path()));
  std::filesystem::remove(path);
  check_events(*reader);
  reader->seek(0);
  check_events(*reader);
}

TEST_CASE("Faults found when a file of a ROS 2 recording is opened are reported each time it is read") {
  const testing::TemporaryFolder folder;
  folder.write("a_0.mcap", mcap_of(0, kPackets));  // without a summary
  folder.write("metadata.yaml", metadata({"a_0.mcap"}));
  const auto reader = open_events(folder.path());
  for (int i = 0; i < 2; ++i) {
    reader->seek(0);
    check_events(*reader);
    REQUIRE(reader->faults().all().size() == 1);
    CHECK(reader->faults().all().begin()->second.count == 1);
    CHECK_THAT(reader->faults().all().begin()->first, Catch::Matchers::StartsWith("no summary"));
  }
}

TEST_CASE("Reading a ROS 2 recording is interrupted, also while a file is unpacked") {
  const std::string kind = GENERATE("sqlite", "mcap", "mcap, compressed");
  CAPTURE(kind);
  const testing::TemporaryFolder folder, others;
  const TemporaryFilesIn temporary(others.path());
  const std::string content = kind == "sqlite" ? sqlite_of(folder, 0, kPackets, false) : mcap_of(0, kPackets);
  const bool packed = kind.ends_with("compressed");
  folder.write("a_0", packed ? compressed(content) : content);
  folder.write("metadata.yaml", metadata({"a_0"}, packed ? "FILE" : ""));
  const Interruption interruption("interrupted");
  std::raise(SIGTERM);
  CHECK_THROWS_WITH(testing::read_all(folder.path()), "interrupted");
  CHECK(std::filesystem::is_empty(others.path()));
}

TEST_CASE("A ROS 2 recording lacking one of its files is read without it and says so, lacking all it is refused") {
  const testing::TemporaryFolder folder;
  write_recording(folder);
  std::filesystem::remove(folder.file("a_0.mcap"));
  const auto reader = open_events(folder.path());
  check_events(*reader, kPackets / 2);
  const auto& faults = reader->faults().all();
  REQUIRE(faults.contains("files of the recording that are missing"));
  CHECK(faults.at("files of the recording that are missing").first == folder.file("a_0.mcap"));
  CHECK_THROWS_WITH(open_events(folder.path(), {.strict = true}), Catch::Matchers::ContainsSubstring("a_0.mcap"));
  std::filesystem::remove(folder.file("a_1.mcap"));
  CHECK_THROWS_WITH(open_events(folder.path()), Catch::Matchers::ContainsSubstring("has none of the files"));
}

TEST_CASE("Broken files of a ROS 2 recording are passed over and counted: other content, cut short, bombs") {
  const testing::TemporaryFolder folder;
  write_recording(folder);
  const std::string packed = compressed(mcap_of(0, kPackets / 2));
  const std::string content =
      GENERATE_COPY(as<std::string>(), "something else", "", packed.substr(0, packed.size() / 2),
                    compressed(std::string(64 << 20, '\0')), "SQLite format 3");
  CAPTURE(content.size());
  folder.write("a_0.mcap", content);
  const auto reader = open_events(folder.path());
  check_events(*reader, kPackets / 2);
  CHECK(reader->faults().all().contains("files of the recording that can't be read"));
  CHECK_THROWS_AS(testing::read_all(folder.path(), {.strict = true}), InputError);
}

TEST_CASE("A ROS 2 recording's broken metadata is refused with a sentence") {
  const testing::TemporaryFolder folder;
  write_recording(folder);
  const std::string start = "rosbag2_bagfile_information:\n";
  for (const std::string& broken : {
           start,
           start + "  relative_file_paths: []\n",
           start + "  relative_file_paths: [{a: 1}]\n",
           start + "  relative_file_paths: [a_0.mcap]\n  topics_with_message_count: [{}]\n",
           start + "  relative_file_paths: [\"a",
           start + "  relative_file_paths: " + std::string(200'000, '['),
           start + "  relative_file_paths: [a_0.mcap]\n  compression_format: lz4\n",
           start + "  relative_file_paths: [a_0.mcap]\n",
           start + std::string(3 << 20, ' '),
       }) {
    folder.write("metadata.yaml", broken);
    CAPTURE(broken.substr(0, 100));
    CHECK_THROWS_WITH(open_events(folder.path()), Catch::Matchers::StartsWith(folder.path()));
  }
}

TEST_CASE("A ROS 2 recording's metadata names only files in its folder") {
  const testing::TemporaryFolder folder, other;
  write_recording(folder);
  const std::string elsewhere = other.write("b.mcap", mcap_of(0, kPackets));
  folder.write("metadata.yaml", metadata({"a_0.mcap", "../" + elsewhere}));
  CHECK(testing::read_all(folder.path()).size() == kPackets / 2);
}

TEST_CASE("A ROS 2 recording's metadata with broken bytes anywhere is never a crash") {
  const testing::TemporaryFolder folder;
  write_recording(folder);
  const std::string whole = metadata({"a_0.mcap", "a_1.mcap"});
  const std::string insertions = std::string("\0\xFF:-[{\"'&*!|\n \t%", 16);
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    std::string broken = whole;
    broken[i] = insertions[i / 3 % insertions.size()];
    folder.write("metadata.yaml", broken);
    CAPTURE(i);
    try {
      const auto events = testing::read_all(folder.path());
      CHECK(events.size() <= kPackets);
    } catch (const InputError& error) {
      CHECK_FALSE(std::string(error.what()).empty());
    }
  }
}
