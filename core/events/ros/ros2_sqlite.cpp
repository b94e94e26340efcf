#include "core/events/ros/ros2_sqlite.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

using namespace ros;

constexpr std::string_view kSqliteMagic = "SQLite format 3";

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

class SqliteBag : public MessageSource {
 public:
  SqliteBag(const std::string& path, Faults& faults, bool count);

  const std::vector<Connection>& connections() const override { return connections_; }
  void select(std::set<std::uint32_t> connections) override {
    selected_ = std::move(connections);
    seek(std::numeric_limits<std::int64_t>::min());
  }
  std::optional<Message> next() override;
  void seek(std::int64_t t) override {
    order_.reset();
    from_ = t;
    ended_ = false;
  }

 private:
  Statement prepare(const std::string& query);
  bool step(sqlite3_stmt* statement);
  std::string text(sqlite3_stmt* statement, int column) const;
  void read_topics();
  void count_messages();

  std::string path_;
  Faults& faults_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  bool whole_ = true;  ///< no pages are missing
  std::vector<Connection> connections_;
  std::set<std::uint32_t> selected_;
  Statement order_, message_;  ///< row ids by time, sorted on disk if there is no index; one row
  std::int64_t from_ = 0;      ///< [ns]
  bool ended_ = false;
};

/// SQLite's URI of a file that is only read. If there is no journal next to it, nothing is locked: read-only folders
/// work.
std::string uri(const std::string& path) {
  std::string result = "file://";  // no host
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      result += fmt::format("%{:02X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  const bool journal = std::filesystem::exists(path + "-wal") || std::filesystem::exists(path + "-journal");
  return result + (journal ? "?mode=ro" : "?mode=ro&immutable=1");
}

/// How many of its pages a file lacks; SQLite reads pages that are missing as zeros if it does not check them. 0 if a
/// journal may have them.
std::uint64_t missing_pages(const std::string& path) {
  // Big-endian: the size of a page (1: 64 KiB) at byte 16, their number at byte 28.
  std::array<std::byte, 32> header{};
  FileBytes file(path);
  if (file.read(0, header) < header.size() || std::filesystem::exists(path + "-wal")) return 0;
  const auto number = [&](std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) value = value << 8 | static_cast<std::uint64_t>(header[i]);
    return value;
  };
  const std::uint64_t size = number(16, 2) == 1 ? 65536 : number(16, 2), count = number(28, 4);
  const std::uint64_t whole = size == 0 ? count : file.size() / size;
  return count > whole ? count - whole : 0;
}

SqliteBag::SqliteBag(const std::string& path, Faults& faults, bool count) : path_(path), faults_(faults) {
  constexpr int kMostMessageBytes = 256 << 20;  // of a message
  constexpr int kSteps = 10'000;                // of SQLite's machine between two checks for an interruption
  sqlite3* database = nullptr;
  const int result = sqlite3_open_v2(uri(path).c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  database_.reset(database);
  if (result != SQLITE_OK) throw InputError(fmt::format("{}: SQLite cannot open it: {}", path, sqlite3_errstr(result)));
  if (const std::uint64_t missing = missing_pages(path); missing > 0) {
    whole_ = false;
    faults_.add("pages missing at the end: the file is cut short", fmt::format("{} of them", missing));
  }
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kMostMessageBytes);
  sqlite3_progress_handler(
      database, kSteps, [](void*) { return Interruption::is_requested() ? 1 : 0; }, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  const Statement tables =
      prepare("SELECT COUNT(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')");
  if (!step(tables.get()) || sqlite3_column_int(tables.get(), 0) != 2) {
    throw InputError(fmt::format("{}: is no ROS 2 bag; expected the tables topics and messages", path));
  }
  read_topics();
  if (count) count_messages();
}

Statement SqliteBag::prepare(const std::string& query) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), query.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
    throw InputError(fmt::format("{}: is broken or no ROS 2 bag: {}", path_, sqlite3_errmsg(database_.get())));
  }
  return Statement(statement);
}

/// False at the end, and if the file is broken: a fault.
bool SqliteBag::step(sqlite3_stmt* statement) {
  const int result = sqlite3_step(statement);
  check_interruption();
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) {
    faults_.add("broken or cut pages, where reading ends", sqlite3_errmsg(database_.get()));
  }
  return false;
}

std::string SqliteBag::text(sqlite3_stmt* statement, int column) const {
  const auto* characters = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return characters == nullptr ? "" : characters;
}

void SqliteBag::read_topics() {
  const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  while (step(topics.get())) {
    connections_.push_back({static_cast<std::uint32_t>(sqlite3_column_int64(topics.get(), 0)),
                            text(topics.get(), 1),
                            plain_type(text(topics.get(), 2)),
                            {},
                            text(topics.get(), 3) == "cdr"});
  }
}

/// SQLite has to read half of the file to count the messages of several topics; for one it has an index.
void SqliteBag::count_messages() {
  for (Connection& connection : connections_) connection.count = 0;
  const Statement counts =
      prepare(connections_.size() == 1 ? fmt::format("SELECT {}, COUNT(*) FROM messages", connections_.front().id)
                                       : "SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
  while (step(counts.get())) {
    for (Connection& connection : connections_) {
      if (connection.id == static_cast<std::uint32_t>(sqlite3_column_int64(counts.get(), 0))) {
        connection.count = static_cast<std::uint64_t>(sqlite3_column_int64(counts.get(), 1));
      }
    }
  }
}

/// A file that is cut short also lacks part of its index of times: it is read in the order of its rows.
std::optional<Message> SqliteBag::next() {
  if (ended_) return std::nullopt;
  if (!order_) {
    order_ = prepare(fmt::format("SELECT id FROM messages WHERE topic_id IN ({}) AND {}timestamp >= {} ORDER BY {}id",
                                 fmt::join(selected_, ", "), whole_ ? "" : "+", from_, whole_ ? "timestamp, " : ""));
    message_ = prepare("SELECT topic_id, data FROM messages WHERE id = ?");
  }
  sqlite3_reset(message_.get());
  if (step(order_.get())) {
    sqlite3_bind_int64(message_.get(), 1, sqlite3_column_int64(order_.get(), 0));
    if (step(message_.get())) {
      const void* const data = sqlite3_column_blob(message_.get(), 1);
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(message_.get(), 1));
      return Message{static_cast<std::uint32_t>(sqlite3_column_int64(message_.get(), 0)),
                     Wire::cdr,
                     {static_cast<const std::byte*>(data), data == nullptr ? 0 : size}};
    }
  }
  ended_ = true;
  return std::nullopt;
}

}  // namespace

std::unique_ptr<MessageSource> open_sqlite_bag(const std::string& path, Faults& faults, bool count) {
  return std::make_unique<SqliteBag>(path, faults, count);
}

bool is_sqlite(std::span<const std::byte> head) {
  return head.size() >= kSqliteMagic.size() &&
         std::equal(kSqliteMagic.begin(), kSqliteMagic.end(), head.begin(),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

EventFormat ros2_sqlite_format() {
  return {"ros2-sqlite", "ROS 2 bag in SQLite (.db3) with event_camera_msgs",
          [](const std::string&, std::span<const std::byte> head) { return is_sqlite(head); },
          [](const std::string& path, const ReadOptions& options) {
            return read_bag(path, "ROS 2 bag (SQLite)", options,
                            [path](Faults& faults) { return open_sqlite_bag(path, faults, true); });
          }};
}

}  // namespace evbench
