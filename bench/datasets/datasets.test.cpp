#include <archive.h>
#include <archive_entry.h>
#include <httplib.h>

#include <csignal>
#include <fstream>
#include <map>
#include <thread>

#include "bench/datasets/download.hpp"
#include "bench/datasets/fetch.hpp"
#include "bench/datasets/unpack.hpp"
#include "bench/testing/program.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Serves one file at /file.zip and counts; connections can be cut and ranges ignored. Others at /more/NAME.
class Server {
 public:
  explicit Server(std::string content) : content_(std::move(content)) {
    server_.Get("/file.zip", [this](const httplib::Request& request, httplib::Response& response) {
      ++requests_;
      last_range_ = request.get_header_value("Range");
      serve(request, response);
    });
    server_.Get("/moved.zip",
                [](const httplib::Request&, httplib::Response& response) { response.set_redirect("/file.zip"); });
    server_.Get("/broken.zip", [this](const httplib::Request&, httplib::Response& response) {
      ++requests_;
      response.status = 503;
    });
    server_.Get("/more/(.*)", [this](const httplib::Request& request, httplib::Response& response) {
      const std::string name = request.matches[1];
      ++asked_for[name];
      if (more.count(name) == 0) {
        response.status = 404;
      } else {
        response.set_content(more[name], name.ends_with(".html") ? "text/html; charset=utf-8" : "application/zip");
      }
    });
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }
  ~Server() {
    server_.stop();
    thread_.join();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url(const std::string& name = "file.zip") const {
    return "http://127.0.0.1:" + std::to_string(port_) + "/" + name;
  }

  int cuts = 0;  ///< connections that are still to be cut, in the middle of what was asked for
  bool knows_ranges = true;
  std::string etag = "\"1\"", last_modified;
  std::map<std::string, std::string> more;
  std::map<std::string, int> asked_for;  ///< of these
  int requests() const { return requests_; }
  const std::string& last_range() const { return last_range_; }
  void change(std::string content) { content_ = std::move(content); }

 private:
  void serve(const httplib::Request& request, httplib::Response& response) {
    std::string body = content_;
    if (!etag.empty()) response.set_header("ETag", etag);
    if (!last_modified.empty()) response.set_header("Last-Modified", last_modified);
    const std::string condition = request.get_header_value("If-Range");
    const bool same = condition.empty() || condition == etag || condition == last_modified;
    const bool ranged = knows_ranges && last_range_.starts_with("bytes=") && same;
    if (ranged) {
      const std::size_t from = std::stoul(last_range_.substr(6));
      if (from >= body.size()) {
        response.status = 416;
        response.set_header("Content-Range", "bytes */" + std::to_string(body.size()));
        return;
      }
      // The library cuts answers without a status: this one is made by hand.
      response.status = 206;
      response.set_header("Content-Range", "bytes " + std::to_string(from) + "-" + std::to_string(body.size() - 1) +
                                               "/" + std::to_string(body.size()));
      body = body.substr(from);
    }
    const_cast<httplib::Request&>(request).ranges.clear();
    const std::size_t given = cuts > 0 ? body.size() / 2 : body.size();
    cuts -= cuts > 0 ? 1 : 0;
    response.set_content_provider(body.size(), "application/zip",
                                  [body, given](std::size_t offset, std::size_t, httplib::DataSink& sink) {
                                    if (offset >= given) return false;
                                    return sink.write(body.data() + offset, given - offset);
                                  });
  }

  std::string content_;
  httplib::Server server_;
  int port_ = 0;
  std::thread thread_;
  std::atomic<int> requests_ = 0;
  std::string last_range_;
};

DownloadOptions quick() {
  DownloadOptions options;
  options.pause = std::chrono::milliseconds(0);
  return options;
}

std::string noise(std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) text += static_cast<char>(i * i / 7 % 251);
  return text;
}

struct ArchiveEntry {
  std::string name, content;
  unsigned type = AE_IFREG;
  std::string target = {};
};

/// A zip, or a tar.gz.
std::string make_archive(const std::string& path, const std::vector<ArchiveEntry>& entries) {
  archive* const a = archive_write_new();
  if (path.ends_with(".zip")) {
    archive_write_set_format_zip(a);
  } else {
    archive_write_set_format_pax_restricted(a);
    archive_write_add_filter_gzip(a);
  }
  REQUIRE(archive_write_open_filename(a, path.c_str()) == ARCHIVE_OK);
  for (const ArchiveEntry& e : entries) {
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_pathname(entry, e.name.c_str());
    archive_entry_set_filetype(entry, e.type);
    archive_entry_set_perm(entry, 0644);
    archive_entry_set_size(entry, static_cast<la_int64_t>(e.content.size()));
    if (e.type == AE_IFLNK) archive_entry_set_symlink(entry, e.target.c_str());
    REQUIRE(archive_write_header(a, entry) == ARCHIVE_OK);
    archive_write_data(a, e.content.data(), e.content.size());
    archive_entry_free(entry);
  }
  archive_write_close(a);
  archive_write_free(a);
  return path;
}

std::string made_folder(const TemporaryFolder& folder, const std::string& name) {
  std::filesystem::create_directory(folder.file(name));
  return folder.file(name);
}

}  // namespace

TEST_CASE("A download has the file's bytes, also after a redirection, and leaves nothing else") {
  const TemporaryFolder folder;
  const Server server(noise(300000));
  std::uint64_t reported = 0;
  DownloadOptions options = quick();
  options.sha256 = sha256(noise(300000));
  options.progress = [&](std::uint64_t have, std::optional<std::uint64_t> total) {
    reported = have;
    CHECK(total == 300000u);
  };
  download(server.url(GENERATE("file.zip", "moved.zip")), folder.file("a.zip"), options);
  CHECK(read_file(folder.file("a.zip")) == noise(300000));
  CHECK(reported == 300000);
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.zip"});
}

TEST_CASE("A download whose connection is cut goes on where it stopped, or from the beginning without ranges") {
  const TemporaryFolder folder;
  Server server(noise(300000));
  server.cuts = 3;
  server.knows_ranges = GENERATE(true, false);
  download(server.url(), folder.file("a.zip"), quick());
  CHECK(read_file(folder.file("a.zip")) == noise(300000));
  CHECK(server.requests() == 4);
  CHECK_THAT(server.last_range(), Catch::Matchers::StartsWith("bytes="));
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.zip"});
}

TEST_CASE("A download that broke off too often reports it, and the next call goes on") {
  const TemporaryFolder folder;
  Server server(noise(300000));
  server.cuts = 2;
  DownloadOptions options = quick();
  options.attempts = 2;
  CHECK_THROWS_WITH(download(server.url(), folder.file("a.zip"), options),
                    ContainsSubstring("broke off after 225000 bytes") && ContainsSubstring("goes on from there"));
  CHECK(read_file(folder.file("a.zip.part")) == noise(225000));
  download(server.url(), folder.file("a.zip"), options);
  CHECK(server.last_range() == "bytes=225000-");
  CHECK(read_file(folder.file("a.zip")) == noise(300000));
}

TEST_CASE("A file that changed on the server since the download broke off is fetched from its beginning") {
  const TemporaryFolder folder;
  Server server(noise(300000));
  server.cuts = 1;
  DownloadOptions options = quick();
  options.attempts = 1;
  CHECK_THROWS_AS(download(server.url(), folder.file("a.zip"), options), InputError);
  server.change(std::string(200000, 'x'));
  server.etag = "\"2\"";
  download(server.url(), folder.file("a.zip"), options);
  CHECK(read_file(folder.file("a.zip")) == std::string(200000, 'x'));
}

TEST_CASE(
    "Without a strong tag the time of the last change identifies a version, without either all is fetched again") {
  const TemporaryFolder folder;
  Server server(noise(300000));
  server.cuts = 1;
  server.etag = GENERATE("", "W/\"1\"");
  const bool dated = GENERATE(true, false), changed = GENERATE(true, false);
  if (dated) server.last_modified = "Tue, 01 Jul 2025 00:00:00 GMT";
  DownloadOptions options = quick();
  options.attempts = 1;
  CHECK_THROWS_WITH(download(server.url(), folder.file("a.zip"), options),
                    ContainsSubstring(dated ? "goes on from there" : "begins anew"));
  const std::string now = changed ? std::string(310000, 'x') : noise(300000);
  if (changed && dated) server.last_modified = "Wed, 02 Jul 2025 00:00:00 GMT";
  server.change(now);
  download(server.url(), folder.file("a.zip"), options);
  CHECK(server.last_range() == (dated ? "bytes=150000-" : ""));
  CHECK(read_file(folder.file("a.zip")) == now);
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.zip"});
}

TEST_CASE("A download of which all bytes are there, but which was not finished, is not fetched again") {
  const TemporaryFolder folder;
  const Server server(noise(1000));
  folder.write("a.zip.part", noise(1000));
  folder.write("a.zip.part.version", "\"1\"");
  download(server.url(), folder.file("a.zip"), quick());
  CHECK(server.last_range() == "bytes=1000-");
  CHECK(server.requests() == 1);
  CHECK(read_file(folder.file("a.zip")) == noise(1000));
}

TEST_CASE("A web page instead of a file is an error, a file that begins like one is not") {
  const TemporaryFolder folder;
  Server server("");
  server.more = {{"a.zip", "\n<!DOCTYPE HTML><p>Not found"}, {"b.html", "<?xml?><html>"}, {"c.xml", "<?xml?><a/>"}};
  for (const char* name : {"more/a.zip", "more/b.html"}) {
    CHECK_THROWS_WITH(download(server.url(name), folder.file("a"), quick()),
                      ContainsSubstring("answers with a web page"));
  }
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK_NOTHROW(download(server.url("more/c.xml"), folder.file("c.xml"), quick()));
}

TEST_CASE("A download that is interrupted reports it and keeps its part file", "[slow]") {
  const TemporaryFolder folder;
  const Server server(noise(30000000));
  DownloadOptions options = quick();
  options.progress = [](std::uint64_t, std::optional<std::uint64_t>) {
    if (!Interruption::is_requested()) std::raise(SIGTERM);
  };
  {
    const Interruption interruption("interrupted");
    CHECK_THROWS_WITH(download(server.url(), folder.file("a.zip"), options), "interrupted");
  }
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.zip.part", "a.zip.part.version"});
  download(server.url(), folder.file("a.zip"), quick());
  CHECK_THAT(server.last_range(), Catch::Matchers::StartsWith("bytes="));
  CHECK(read_file(folder.file("a.zip")) == noise(30000000));
}

TEST_CASE("An error while a download is written passes through") {
  const TemporaryFolder folder;
  const Server server(noise(1000));
  CHECK_THROWS_WITH(download(server.url(), folder.file("no/a.zip"), quick()),
                    ContainsSubstring("a.zip.part: can't be written"));
}

TEST_CASE("A part file that is longer than the server's file is removed") {
  const TemporaryFolder folder;
  const Server server(noise(1000));
  folder.write("a.zip.part", std::string(5000, 'x'));
  download(server.url(), folder.file("a.zip"), quick());
  CHECK(read_file(folder.file("a.zip")) == noise(1000));
}

TEST_CASE("A refusal by the server, a wrong checksum and a file that is too big are errors with the reason") {
  const TemporaryFolder folder;
  const Server server(noise(1000));
  CHECK_THROWS_WITH(download(server.url("no.zip"), folder.file("a.zip"), quick()),
                    ContainsSubstring("no.zip") && ContainsSubstring("answers 404"));
  CHECK_THROWS_WITH(download(server.url("broken.zip"), folder.file("a.zip"), quick()), ContainsSubstring("503"));
  CHECK(server.requests() == 5);
  DownloadOptions options = quick();
  options.sha256 = std::string(64, '0');
  CHECK_THROWS_WITH(download(server.url(), folder.file("a.zip"), options),
                    ContainsSubstring("has the SHA-256 " + sha256(noise(1000))) && ContainsSubstring("removed"));
  options = quick();
  options.limit = 999;
  CHECK_THROWS_WITH(download(server.url(), folder.file("a.zip"), options), ContainsSubstring("bigger"));
  CHECK_THROWS_AS(download("http://127.0.0.1:1/file.zip", folder.file("a.zip"), quick()), InputError);
  CHECK_THROWS_AS(download("file:///etc/hostname", folder.file("a.zip"), quick()), InputError);
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("An archive is unpacked, without the folder that all of it is in") {
  const TemporaryFolder folder;
  const std::string name = GENERATE("a.zip", "a.tar.gz");
  const std::string plain = made_folder(folder, "plain"), wrapped = made_folder(folder, "wrapped");
  unpack(make_archive(folder.file(name), {{"events.txt", noise(200000)}, {"images/1.png", "1"}}), plain, 1 << 20);
  CHECK(read_file(plain + "/events.txt") == noise(200000));
  CHECK(read_file(plain + "/images/1.png") == "1");
  unpack(make_archive(folder.file(name), {{"seq/events.txt", "e"}, {"seq/seq/1.png", "1"}}), wrapped, 1 << 20);
  CHECK(read_file(wrapped + "/events.txt") == "e");
  CHECK(read_file(wrapped + "/seq/1.png") == "1");
}

TEST_CASE("An archive with names outside the folder, links or repeated names, or that is too big, is refused") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<ArchiveEntry>& entries, const std::string& message) {
    for (const char* name : {"a.zip", "a.tar.gz"}) {
      INFO(name << " " << entries[0].name);
      const std::string target = folder.file("target");
      std::filesystem::remove_all(target);
      std::filesystem::create_directory(target);
      CHECK_THROWS_WITH(unpack(make_archive(folder.file(name), entries), target, 1000), ContainsSubstring(message));
    }
  };
  refused({{"../out.txt", "x"}}, "leads out");
  refused({{"a/../../out.txt", "x"}}, "leads out");
  refused({{"/tmp/out.txt", "x"}}, "leads out");
  refused({{"..\\out.txt", "x"}}, "leads out");
  refused({{"link", "", AE_IFLNK, "/etc"}, {"link/out.txt", "x"}}, "link or device");
  refused({{"a.txt", "x"}, {"a.txt", "y"}}, "twice");
  refused({{"a.txt", std::string(600, 'x')}, {"b.txt", std::string(600, 'x')}}, "more than the catalogue allows");
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.zip", "a.tar.gz", "target"});
  folder.write("b.zip", "no zip at all");
  CHECK_THROWS_WITH(unpack(folder.file("b.zip"), folder.file("target"), 1000),
                    ContainsSubstring("b.zip: is a damaged archive"));
}

TEST_CASE("A zip that is truncated or has a flipped bit is refused") {
  const TemporaryFolder folder;
  const std::string bytes = read_file(make_archive(folder.file("a.zip"), {{"events.txt", noise(5000)}}));
  folder.write("short.zip", bytes.substr(0, bytes.size() / 2));
  CHECK_THROWS_AS(unpack(folder.file("short.zip"), made_folder(folder, "short"), 1 << 20), InputError);
  std::string flipped = bytes;
  flipped[1000] = static_cast<char>(flipped[1000] ^ 4);
  folder.write("flipped.zip", flipped);
  CHECK_THROWS_AS(unpack(folder.file("flipped.zip"), made_folder(folder, "flipped"), 1 << 20), InputError);
}

TEST_CASE("Names in an archive may be of any language") {
  const TemporaryFolder folder;
  const std::string bytes = read_file(make_archive(folder.file("a.zip"), {{"ae_name.txt", "x"}, {"b.txt", "y"}}));
  std::string named = bytes;  // libarchive writes such names only where the locale has them
  for (std::size_t at = named.find("ae_name"); at != std::string::npos; at = named.find("ae_name", at + 7)) {
    named.replace(at, 2, "\xc3\xa4");
    // Bit 11 of the flags: the name is UTF-8. They are before the name, by what the kind of header says.
    const bool central = at >= 46 && named.compare(at - 46, 4, "PK\1\2") == 0;
    named[at - (central ? 46 - 9 : 30 - 7)] = static_cast<char>(named[at - (central ? 46 - 9 : 30 - 7)] | 8);
  }
  folder.write("named.zip", named);
  unpack(folder.file("named.zip"), made_folder(folder, "out"), 1000);
  CHECK(read_file(folder.file("out/\xc3\xa4_name.txt")) == "x");
  CHECK(read_file(folder.file("out/b.txt")) == "y");
}

TEST_CASE("Downloaded files of a dataset stay until it is complete, and a damaged archive is fetched again") {
  const TemporaryFolder folder;
  Server server("");
  const std::string zip = read_file(make_archive(folder.file("b.zip"), {{"events.txt", noise(5000)}}));
  server.more = {{"a.h5", noise(1000)}};
  Dataset dataset;
  dataset.limit_gib = 1.0;
  dataset.files = {{server.url("more/a.h5"), "a.h5", "", false}, {server.url("more/b.zip"), "b.zip", "", true}};
  const std::string target = folder.file("set");
  const auto fetch = [&] { fetch_dataset(dataset, target, quick(), [](const std::string&) {}); };
  CHECK_THROWS_WITH(fetch(), ContainsSubstring("b.zip") && ContainsSubstring("404"));
  CHECK(names_in(folder.path()) == std::set<std::string>{"b.zip", "set.download"});
  CHECK(names_in(target + ".download") == std::set<std::string>{"a.h5"});
  server.more["b.zip"] = zip.substr(0, zip.size() / 2);
  CHECK_THROWS_WITH(fetch(),
                    ContainsSubstring("damaged archive") && ContainsSubstring("removed, the same command fetches"));
  CHECK(names_in(target + ".download") == std::set<std::string>{"a.h5"});
  server.more["b.zip"] = zip;
  fetch();
  CHECK(server.asked_for["a.h5"] == 1);
  CHECK(server.asked_for["b.zip"] == 3);
  CHECK(read_file(target + "/a.h5") == noise(1000));
  CHECK(read_file(target + "/events.txt") == noise(5000));
  CHECK(names_in(folder.path()) == std::set<std::string>{"b.zip", "set", "set.fetched.json"});
  const Json record = parse_json(read_file(record_of_dataset(target)));
  CHECK(record["downloads"][1]["url"] == server.url("more/b.zip"));
  CHECK(record["downloads"][1]["bytes"] == zip.size());
  CHECK(record["downloads"][1]["sha256"] == sha256(zip));
}

TEST_CASE("A file of an earlier call is fetched again when its checksum is not the expected one") {
  const TemporaryFolder folder;
  Server server("");
  server.more = {{"a.h5", noise(1000)}};
  Dataset dataset;
  dataset.limit_gib = 1.0;
  dataset.files = {{server.url("more/a.h5"), "a.h5", sha256(noise(1000)), false}};
  std::filesystem::create_directory(folder.file("set.download"));
  folder.write("set.download/a.h5", noise(999));
  fetch_dataset(dataset, folder.file("set"), quick(), [](const std::string&) {});
  CHECK(read_file(folder.file("set/a.h5")) == noise(1000));
}

TEST_CASE("dataset get fetches and unpacks by name, once, and dataset list marks installed ones", "[slow]") {
  const TemporaryFolder folder;
  make_archive(folder.file("sequence.zip"),
               {{"events.txt", "0.1 1 1 1\n"}, {"calib.txt", "200 200 120 90 0 0 0 0 0\n"}});
  Server server(read_file(folder.file("sequence.zip")));
  server.cuts = 1;
  const Json files = {{{"url", server.url("{name}.zip")}, {"unpack", true}}};
  folder.write(
      "catalogue.json",
      Json{{"collections",
            {{{"name", "local"},
              {"title", "Test"},
              {"homepage", "h"},
              {"licence", "CC0"},
              {"verified", "yes"},
              {"limit_gib", 1},
              {"files", files},
              {"sequences", {{{"name", "file"}, {"description", "d"}}, {{"name", "no"}, {"description", "d"}}}}}}}}
          .dump());
  const std::string environment =
      "export EVBENCH_CATALOGUE=catalogue.json EVBENCH_DATASETS=sets; \"$evbench\" dataset ";
  const Outcome get = testing::shell(folder, environment + "get local/file");
  CHECK(get.exit_code == 0);
  CHECK(get.err.empty());
  CHECK_THAT(get.out, ContainsSubstring("CC0") &&
                          ContainsSubstring("SHA-256 " + sha256_file(folder.file("sequence.zip"))) &&
                          ContainsSubstring("written: sets/local/file"));
  CHECK(read_file(folder.file("sets/local/file/events.txt")) == "0.1 1 1 1\n");
  CHECK(names_in(folder.file("sets/local")) == std::set<std::string>{"file", "file.fetched.json"});
  CHECK_THAT(testing::shell(folder, environment + "get local/file").out, ContainsSubstring("is there already"));
  CHECK(server.requests() == 2);
  CHECK_THAT(testing::shell(folder, environment + "list").out,
             ContainsSubstring("* local/file ") && ContainsSubstring("    local/no "));
  const Outcome missing = testing::shell(folder, environment + "get local/no");
  CHECK(missing.exit_code == 2);
  CHECK_THAT(missing.err, ContainsSubstring("answers 404"));
  CHECK_THAT(testing::shell(folder, environment + "get local/fil").err,
             ContainsSubstring("did you mean \"local/file\"?"));
  CHECK(names_in(folder.file("sets/local")) == std::set<std::string>{"file", "file.fetched.json"});
}

TEST_CASE("dataset verify names every file that is missing, has changed or was added", "[slow]") {
  const TemporaryFolder folder;
  Server server("");
  server.more = {{"a.h5", noise(1000)}, {"b.h5", noise(2000)}};
  Dataset dataset;
  dataset.limit_gib = 1.0;
  dataset.files = {{server.url("more/a.h5"), "a.h5", "", false}, {server.url("more/b.h5"), "b.h5", "", false}};
  const std::string target = folder.file("set");
  fetch_dataset(dataset, target, quick(), [](const std::string&) {});
  CHECK(verify_dataset(target).empty());
  const std::string verify = "EVBENCH_DATASETS=. \"$evbench\" dataset verify set";
  CHECK(testing::shell(folder, verify).exit_code == 0);
  folder.write("set/a.h5", noise(999) + "x");  // of the same size
  std::filesystem::rename(target + "/b.h5", target + "/c.h5");
  const std::vector<std::string> differences = verify_dataset(target);
  REQUIRE(differences.size() == 3);
  CHECK_THAT(differences[0], ContainsSubstring("a.h5: has 1000 bytes, SHA-256 \"" + sha256(noise(999) + "x")));
  CHECK_THAT(differences[1], ContainsSubstring("b.h5: is missing"));
  CHECK_THAT(differences[2], ContainsSubstring("c.h5: is not in the record"));
  CHECK(testing::shell(folder, verify).exit_code == 2);
  folder.write("set.fetched.json", "[]");
  CHECK_THROWS_WITH(verify_dataset(target), ContainsSubstring("is no record of a dataset"));
  std::filesystem::remove(folder.file("set.fetched.json"));
  CHECK_THROWS_WITH(verify_dataset(target), ContainsSubstring("evbench dataset get wrote"));
}
