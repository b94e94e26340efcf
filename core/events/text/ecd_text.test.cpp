#include "core/events/text/ecd_text.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <filesystem>

#include "core/events/formats.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

std::unique_ptr<EventReader> text(const std::string& content, const ReadOptions& options = {}) {
  return open_text(bytes_of(content), options);
}

/// None when it is refused.
std::vector<Event> events_if_any(const std::string& content) {
  try {
    return read_all(*text(content));
  } catch (const InputError&) {
    return {};
  }
}

std::vector<Event> events_of(const std::string& content) { return read_all(*text(content)); }

std::string ecd_metadata(const EventReader& reader, const std::string& key) {
  for (const auto& [name, value] : reader.info().metadata) {
    if (name == key) return value;
  }
  return "";
}

/// A .zip of files by name and content.
void write_zip(const std::string& path, const std::vector<std::pair<std::string, std::string>>& files) {
  archive* const zip = archive_write_new();
  archive_write_set_format_zip(zip);
  REQUIRE(archive_write_open_filename(zip, path.c_str()) == ARCHIVE_OK);
  for (const auto& [name, content] : files) {
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
    REQUIRE(archive_write_header(zip, entry) == ARCHIVE_OK);
    REQUIRE(archive_write_data(zip, content.data(), content.size()) == static_cast<la_ssize_t>(content.size()));
    archive_entry_free(entry);
  }
  REQUIRE(archive_write_free(zip) == ARCHIVE_OK);
}

const std::string kPng("\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR\0\0\0\xF0\0\0\0\xB4", 24);
const std::vector<std::pair<std::string, std::string>> kRecording{
    {"events.txt", "0.003811000 96 133 0\n0.003820001 127 171 1\n"},
    {"calib.txt", "199.1 198.8 132.2 110.7 -0.37 0.15 0 0 0\n"},
    {"groundtruth.txt", "0.1 0 0 0 0 0 0 1\n0.2 1 0 0 0 0 0 1\n"},
    {"images/frame_00000000.png", kPng}};
const std::vector<Event> kTwo{{3811, 96, 133, false}, {3820, 127, 171, true}};

}  // namespace

TEST_CASE("Real excerpts of the Event-Camera Dataset are read to their last line") {
  const struct {
    const char* file;
    std::size_t count;
    Event first;
    std::int64_t last;
  } cases[] = {
      {"slider_depth/events_chunk.txt", 50'000, {3811, 96, 133, false}, 174'000},
      {"shapes_rotation/events_excerpt.txt", 20'000, {2'097'134, 162, 27, false}, 2'195'700},
      {"dynamic_rotation/events_excerpt.txt", 30'000, {19'098'314, 201, 70, false}, 19'119'300},
  };
  for (const auto& [file, count, first, last] : cases) {
    const auto path = data_file(file);
    if (!path) continue;
    const auto reader = open_events(*path);
    const auto events = read_all(*reader);
    REQUIRE(events.size() == count);
    CHECK((events.front() == first));
    CHECK(std::abs(events.back().t - last) < 1000);
    CHECK(reader->faults().empty());
    CHECK(reader->calibration().has_value());
    CHECK(ecd_metadata(*reader, "columns") == "t x y p");
    CHECK(ecd_metadata(*reader, "unit of time") == "seconds (as they have a decimal point)");
  }
}

TEST_CASE("Ground truth, calibration and the pictures' size are found next to real events") {
  const auto path = data_file("slider_depth/events_chunk.txt");
  if (!path) return;
  const auto reader = open_events(*path);
  CHECK(reader->info().width == 240);
  CHECK(reader->info().height == 180);
  REQUIRE(reader->calibration());
  CHECK(reader->calibration()->width == 240);
  REQUIRE(reader->ground_truth());
  CHECK(reader->ground_truth()->size() > 100);
}

TEST_CASE("Both orders, all separators, and names of columns are detected and reported") {
  const struct {
    const char* content;
    const char* columns;
    const char* unit;
  } cases[] = {
      {"0.003811 96 133 0\n0.00382 127 171 1\n", "t x y p", "seconds"},
      {"3811,96,133,0\r\n3820,127,171,1\r\n", "t x y p", "microseconds"},
      {"96,133,-1,3811\n127,171,1,3820\n", "x y p t", "microseconds"},
      {"96;133;0;3811\n127;171;1;3820", "x y p t", "microseconds"},
      {"96\t133\t0\t0.003811\n127\t171\t1\t0.00382\n", "x y p t", "seconds"},
      {"y,x,p,timestamp_ns\n133,96,0,3811000\n171,127,1,3820400\n", "y x p t (named in the file)", "nanoseconds"},
      {"\"t\",\"x\",\"y\",\"extra\",\"polarity\"\n3811,96,133,7,0\n3820,127,171,7,1\n", "t x y - p (named in the file)",
       "microseconds"},
      {"# comment\n\n0.003811 96 133 0\n# another\n3.82e-3 127 171 1\n", "t x y p", "seconds"},
      {"\xEF\xBB\xBFt,x,y,p\n3811,96,133,0\n3820,127,171,1\n", "t x y p (named in the file)", "microseconds"},
      {"t[ms] x y p\n3.811 96 133 0\n3.8204 127 171 1\n", "t x y p (named in the file)", "milliseconds"},
  };
  for (const auto& [content, columns, unit] : cases) {
    CAPTURE(content);
    const auto reader = text(content);
    CHECK((read_all(*reader) == kTwo));
    CHECK(ecd_metadata(*reader, "columns") == columns);
    CHECK_THAT(ecd_metadata(*reader, "unit of time"), Catch::Matchers::StartsWith(unit));
    CHECK(reader->faults().empty());
  }
}

TEST_CASE("Times with a decimal point are seconds, also where the first thousand events are of time zero") {
  CHECK((events_of("0.000000 5 7 1\n") == std::vector<Event>{{0, 5, 7, true}}));
  std::string zeros;
  for (int i = 0; i < 2000; ++i) zeros += "0.000000 5 1 1\n";
  const std::string content = zeros + "0.999 5 1 0\n";
  for (const std::string columns : {"", "t,x,y,p"}) {
    const auto reader = text(content, {.columns = columns});
    const auto events = read_all(*reader);
    REQUIRE(events.size() == 2001);
    CHECK((events.back() == Event{999'000, 5, 1, false}));
    CHECK(ecd_metadata(*reader, "unit of time") == "seconds (as they have a decimal point)");
    CHECK(reader->faults().empty());
  }
}

TEST_CASE("Where whole numbers were taken for microseconds, a time with a fraction is a fault and not another time") {
  std::string content;
  for (int i = 0; i < 2000; ++i) content += fmt::format("{} 5 7 1\n", i);
  const auto reader = text(content + "2000.5 5 7 1\n");
  CHECK(read_all(*reader).size() == 2000);
  const auto& [kind, fault] = *reader->faults().all().begin();
  CHECK_THAT(kind, Catch::Matchers::StartsWith("lines whose time has a fraction, unlike the first ones"));
  CHECK(fault.first == "line 2001");
  const auto named = text(content + "2000.5 5 7 1\n", {.columns = "t_us,x,y,p"});
  CHECK(read_all(*named).size() == 2001);
}

TEST_CASE("Names of columns may have blanks, and a first line that is damaged is a fault where columns are asked for") {
  CHECK((events_of("timestamp [us], x, y, polarity\n3811,96,133,0\n3820,127,171,1\n") == kTwo));
  for (const std::string first : {"foo 1 2 1\n", "nan 1 2 1\n"}) {
    const auto reader = text(first + "0.003811 96 133 0\n0.00382 127 171 1\n", {.columns = "t,x,y,p"});
    CHECK((read_all(*reader) == kTwo));
    CHECK(reader->faults().all().at("lines that are no event").first == "line 1");
  }
}

TEST_CASE("Lines whose times are in disorder are still of one order of columns") {
  const auto reader = text("0.004 96 133 0\n0.003 127 171 1\n0.002 96 133 0\n0.001 127 171 1\n");
  CHECK(read_all(*reader).size() == 4);
  CHECK(ecd_metadata(*reader, "columns") == "t x y p");
}

TEST_CASE("A comment that names the four columns is believed, any other is not") {
  const auto reader = text("# a recording\n# x y t[ms] p\n96 133 3.811 0\n127 171 3.82 1\n");
  CHECK((read_all(*reader) == kTwo));
  CHECK(ecd_metadata(*reader, "columns") == "x y t p (named in a comment)");
  CHECK(ecd_metadata(*reader, "unit of time") == "milliseconds");
  CHECK((events_of("# the x y position\n# x y t\n0.003811 96 133 0\n0.00382 127 171 1\n") == kTwo));
}

TEST_CASE("Text that is compressed is read as it is, and anything else that is compressed is refused") {
  const TemporaryFolder folder;
  folder.write("events.txt", kRecording[0].second);
  for (const char* const program : {"gzip", "bzip2", "xz", "zstd"}) {
    CAPTURE(program);
    const std::string path = folder.file(std::string("a.") + program);
    const std::string command = fmt::format("{} -c '{}' > '{}' 2> /dev/null", program, folder.file("events.txt"), path);
    if (std::system(command.c_str()) != 0) continue;  // NOLINT(cert-env33-c,concurrency-mt-unsafe): none of it here
    const auto reader = open_events(path);
    CHECK((read_all(*reader) == kTwo));
    reader->seek(0);
    CHECK((read_all(*reader) == kTwo));
  }
  REQUIRE(std::filesystem::exists(folder.file("a.gzip")));
  const std::string whole = read_file(folder.file("a.gzip"));
  CHECK_THROWS_AS(open_events(folder.write("cut.gz", whole.substr(0, whole.size() / 2))), InputError);
  folder.write("bytes", std::string("\0\1\2\3", 4));
  REQUIRE(std::system(fmt::format("gzip '{}'", folder.file("bytes")).c_str()) == 0);  // NOLINT
  CHECK_THROWS_WITH(open_events(folder.file("bytes.gz")), Catch::Matchers::ContainsSubstring("no known event format"));
}

TEST_CASE("Text that may be of either order, or of another one, asks for the columns") {
  CHECK_THROWS_WITH(text("1 2 1 1\n0 3 0 0\n"),
                    Catch::Matchers::ContainsSubstring("test:1: has lines like \"1 2 1 1\"") &&
                        Catch::Matchers::ContainsSubstring("may be \"t x y p\" and \"x y p t\"; give --columns"));
  for (const char* content :
       {"127;171;3811;0\n96;133;3820;1", "0\t96\t133\t0.003811\n1\t127\t171\t0.00382\n", "2 3 4 5\n"}) {
    CHECK_THROWS_WITH(text(content),
                      Catch::Matchers::ContainsSubstring("are neither \"t x y p\" nor \"x y p t\"; give --columns"));
  }
  CHECK_THROWS_WITH(text("0.1 1 2 1 5\n"), Catch::Matchers::ContainsSubstring("has 5 columns") &&
                                               Catch::Matchers::ContainsSubstring("give --columns"));
}

TEST_CASE("Requested columns replace those that are detected, or named in the file") {
  const std::string content = "96 133 3.811 1 9\n127 171 3.82 0 9\n";  // y x t[ms] p
  CHECK_THROWS_WITH(text(content), Catch::Matchers::ContainsSubstring("has 5 columns"));
  for (const std::string header : {"", "a b c d e\n"}) {
    const auto reader = text(header + content, {.columns = "y,x,t_ms,p,other"});
    CHECK((read_all(*reader) == std::vector<Event>{{3811, 133, 96, true}, {3820, 171, 127, false}}));
    CHECK(ecd_metadata(*reader, "columns") == "y x t p - (as asked for)");
    CHECK(ecd_metadata(*reader, "unit of time") == "milliseconds");
    CHECK(reader->faults().empty());
  }
  CHECK_THROWS_WITH(text(content, {.columns = "t,x,y"}),
                    Catch::Matchers::ContainsSubstring("what is asked for: names the columns"));
  CHECK_THROWS_WITH(text(content, {.columns = "t,x,y,p"}),
                    Catch::Matchers::ContainsSubstring("5 columns; expected 4, as they are named"));
}

TEST_CASE("Names that may mean two columns are quoted, unless one is left out of what is asked for") {
  using Catch::Matchers::ContainsSubstring;
  CHECK_THROWS_WITH(text("t,x,x_raw,y,p\n0.1,5,6,7,1\n"),
                    ContainsSubstring("test:1: the columns are named \"x\" and \"x_raw\", either of which may be x") &&
                        ContainsSubstring("--columns"));
  CHECK_THROWS_WITH(text("0.1,5,6,7,1\n", {.columns = "t,x,x_raw,y,p"}),
                    ContainsSubstring("what is asked for: the columns are named \"x\" and \"x_raw\""));
  CHECK(read_all(*text("t,x,x_raw,y,p\n0.1,5,6,7,1\n", {.columns = "t,x,-,y,p"})).front().x == 5);
  CHECK_THROWS_WITH(text("sec nsec x y p\n1 500 5 7 1\n"), ContainsSubstring("the time in one column"));
}

TEST_CASE("Without pictures a calibration that fits the Event-Camera Dataset's sensor determines its size") {
  const TemporaryFolder folder;
  folder.write("events.txt", kRecording[0].second);
  const auto width = [&](const std::string& calibration, const ReadOptions& options = {}) {
    folder.write("calib.txt", calibration);
    return open_events(folder.file("events.txt"), options)->info().width;
  };
  CHECK(width(kRecording[1].second) == 240);
  CHECK(width(kRecording[1].second, {.width = 346, .height = 260}) == 346);
  CHECK(width("199.1 198.8 173 130 -0.37 0.15 0 0 0\n") == 0);
  CHECK(width("no numbers\n") == 0);
}

TEST_CASE("An option for the sensor's size takes precedence over the pictures") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("images"));
  for (const auto& [name, content] : kRecording) folder.write(name, content);
  CHECK(open_events(folder.file("events.txt"))->info().width == 240);
  const auto reader = open_events(folder.file("events.txt"), {.width = 346, .height = 260});
  CHECK(reader->info().width == 346);
  CHECK(reader->info().height == 260);
  CHECK(ecd_metadata(*reader, "sensor size").empty());
}

TEST_CASE("The times of the pictures next to the events are reported") {
  const TemporaryFolder folder;
  folder.write("events.txt", kRecording[0].second);
  folder.write("images.txt", "0.5 images/a.png\n0.75 images/b.png\n");
  CHECK(ecd_metadata(*open_events(folder.file("events.txt")), "pictures") == "2 in images.txt, 0.500 to 0.750 s");
  folder.write("images.txt", "0.5\n");
  CHECK_THAT(ecd_metadata(*open_events(folder.file("events.txt")), "pictures"),
             Catch::Matchers::ContainsSubstring("expected"));
}

TEST_CASE("Times too late for microseconds ask for their unit, times of day are read to the microsecond") {
  const std::string nanoseconds = "1700000000123456789 1 2 1\n";
  CHECK_THROWS_WITH(text(nanoseconds),
                    Catch::Matchers::ContainsSubstring(
                        "too late for microseconds; give --columns (source.columns in a run's config) with t_ns"));
  CHECK(read_all(*text(nanoseconds, {.columns = "t_ns,x,y,p"})).front().t == 1'700'000'000'123'457);
  CHECK(events_of("1700000000.123456789 1 2 1\n").front().t == 1'700'000'000'123'457);
}

TEST_CASE("The sensor's size before the events is read") {
  CHECK(text("240 180\n0.1 1 2 1\n")->info().width == 240);
  CHECK(text("%geometry:1280,720\n1,2,1,100\n")->info().height == 720);
  CHECK(text("0.1 1 2 1\n")->info().width == 0);
  CHECK(text("0.1 1 2 1\n", {.width = 240, .height = 180})->info().width == 240);
}

TEST_CASE("Long files are read across the borders of chunks, and from the beginning after seeking") {
  std::string content;
  std::vector<Event> expected;
  for (int i = 0; i < 60'000; ++i) {
    const Event event{i * 7, static_cast<std::uint16_t>(i % 240), static_cast<std::uint16_t>(i % 180), i % 3 == 0};
    content += fmt::format("{}.{:06} {} {} {}\n", event.t / 1'000'000, event.t % 1'000'000, event.x, event.y,
                           event.on ? 1 : 0);
    expected.push_back(event);
  }
  const auto reader = text(content);
  CHECK((read_all(*reader) == expected));
  reader->seek(1000);
  CHECK((read_all(*reader) == expected));
}

TEST_CASE("Lines that are no event are counted and skipped, or refused") {
  std::string lines;
  for (int i = 0; i < 200; ++i) lines += "0.1 1 2 1\n";
  lines += "0.2 1 2\nnan 1 2 1\n0.3 -1 2 1\n0.3 70000 2 1\n0.3 1.5 2 1\n0.3 1 2 7\n0.4 1 2 1 5\nx\n1e30 1 2 1\n" +
           std::string(400'000, '7') + "\n0.5 3 4 0\n";
  const auto reader = text(lines);
  const auto events = read_all(*reader);
  CHECK(events.size() == 201);
  CHECK((events.back() == Event{500'000, 3, 4, false}));
  const auto& faults = reader->faults().all();
  REQUIRE(faults.size() == 2);
  CHECK(faults.at("lines that are no event").first == "line 201");
  CHECK(faults.at("lines that are no event").count == 9);
  CHECK(faults.at("lines of more than 64 KiB").count == 1);
  CHECK_THROWS_AS(read_all(*text(lines, {.strict = true})), InputError);
}

TEST_CASE("Texts that hold no events are refused") {
  for (const std::string content :
       {"", "\n\n", "# only a comment\n", "0.1 1 2\n", "0.1 1 2 1 5\n", "2 3 4 5\n", "x,y,t\n1,2,3\n",
        "t,x,x,p\n1,2,3,1\n", "once upon a time\n", "0.1 0 0 0 0 0 0 1\n", "t,x,y,p\na,b,c,d\n"}) {
    CAPTURE(content);
    CHECK_THROWS_AS(text(content), InputError);
  }
}

TEST_CASE("A recording is read alike from a folder, a zip, and a zip of a folder") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("recording/images"));
  std::vector<std::pair<std::string, std::string>> nested;
  for (const auto& [name, content] : kRecording) {
    folder.write("recording/" + name, content);
    nested.emplace_back("slider/" + name, content);
  }
  write_zip(folder.file("plain.zip"), kRecording);
  write_zip(folder.file("nested.zip"), nested);
  for (const std::string name : {"recording", "plain.zip", "nested.zip", "recording/events.txt"}) {
    CAPTURE(name);
    const auto reader = open_events(folder.file(name));
    CHECK((read_all(*reader) == kTwo));
    reader->seek(0);
    CHECK((read_all(*reader) == kTwo));
    CHECK(reader->info().width == 240);
    CHECK(reader->info().height == 180);
    CHECK(ecd_metadata(*reader, "companion files") == "calib.txt, groundtruth.txt");
    CHECK_THROWS_WITH(open_events(folder.file(name), {.topic = "/left"}),
                      Catch::Matchers::ContainsSubstring("no topics or groups"));
    REQUIRE(reader->calibration());
    CHECK(reader->calibration()->pinhole.fx == 199.1);
    REQUIRE(reader->ground_truth());
    CHECK(reader->ground_truth()->size() == 2);
  }
}

TEST_CASE("A zip that is broken, or without events, is refused, and a broken file in it is named") {
  const TemporaryFolder folder;
  write_zip(folder.file("none.zip"), {{"readme.txt", "no events"}});
  CHECK_THROWS_WITH(open_events(folder.file("none.zip")),
                    Catch::Matchers::ContainsSubstring("none.zip: has no events.txt"));
  write_zip(folder.file("poses.zip"), {kRecording[0], {"groundtruth.txt", "0.1 0 0\n"}});
  CHECK_THROWS_WITH(open_events(folder.file("poses.zip"))->ground_truth(),
                    Catch::Matchers::ContainsSubstring("poses.zip/groundtruth.txt:1"));
  write_zip(folder.file("two.zip"), {{"a/events.txt", "0.1 1 2 1\n"}, {"b/events.txt", "0.1 1 2 1\n"}});
  CHECK_THROWS_WITH(open_events(folder.file("two.zip")),
                    Catch::Matchers::ContainsSubstring(
                        "two.zip: holds several recordings (a/events.txt, b/events.txt); expected one"));
  write_zip(folder.file("whole.zip"), kRecording);
  const std::string whole = read_file(folder.file("whole.zip"));
  for (std::size_t size = 4; size < whole.size(); size += 7) {
    const auto path = folder.write("cut.zip", whole.substr(0, size));
    std::size_t count = 0;
    try {
      count = read_all(*open_events(path)).size();
    } catch (const InputError&) {
    }
    CHECK(count <= 2);
  }
}

TEST_CASE("What a zip blows up to is not kept in memory", "[slow]") {
  const TemporaryFolder folder;
  const std::string blanks(std::size_t{65} << 20, ' ');
  write_zip(folder.file("bomb.zip"), {{"events.txt", kRecording[0].second + blanks}, {"groundtruth.txt", blanks}});
  const auto reader = open_events(folder.file("bomb.zip"));
  CHECK((read_all(*reader) == kTwo));
  CHECK(fault_counts(*reader) == std::vector<std::int64_t>{1});
  CHECK_THROWS_WITH(reader->ground_truth(), Catch::Matchers::ContainsSubstring("groundtruth.txt: has more than"));
}

TEST_CASE("Texts truncated anywhere, or with any bytes, are read as far as they go") {
  std::string content;
  for (int i = 0; i < 500; ++i) content += fmt::format("0.{:06},{},{},1\n", i, i % 240, i % 180);
  const std::vector<Event> all = events_of(content);
  for (std::size_t size = 100; size < content.size(); size += 97) {
    const auto part = events_of(content.substr(0, size));
    REQUIRE(part.size() <= all.size());
    CHECK(std::equal(part.begin(), part.empty() ? part.end() : part.end() - 1, all.begin()));
  }
  std::uint32_t state = 1;
  for (int round = 0; round < 300; ++round) {
    std::string broken = content;
    for (int i = 0; i < 8; ++i) {
      state = state * 1664525u + 1013904223u;
      broken[(state >> 8) % broken.size()] = static_cast<char>(state >> 24);
    }
    CHECK(events_if_any(broken).size() <= 500 + 8);
  }
}
