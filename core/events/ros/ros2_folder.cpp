#include "core/events/ros/ros2_folder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/decompress.hpp"
#include "core/events/ros/mcap.hpp"
#include "core/events/ros/ros2_metadata.hpp"
#include "core/events/ros/ros2_sqlite.hpp"
#include "core/events/ros/unpacked_file.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

using namespace ros;

constexpr const char* kMetadata = "metadata.yaml";

std::vector<std::byte> head_of(const std::string& path) {
  std::vector<std::byte> head(16);
  FileBytes file(path);
  head.resize(file.read(0, head));
  return head;
}

bool is_zstd(std::span<const std::byte> head) {
  return head.size() >= 4 && load<std::uint32_t>(head.data()) == 0xFD2FB528u;
}

/// One file of a recording, unpacked if it is compressed. The unpacked file is unlinked once it is open, so that it
/// vanishes with the program, however that ends.
std::unique_ptr<MessageSource> open_file(const std::string& recorded, Faults& faults) {
  std::optional<UnpackedFile> unpacked;
  if (is_zstd(head_of(recorded))) unpacked.emplace(recorded);
  const std::string path = unpacked ? unpacked->path() : recorded;
  const auto head = head_of(path);
  if (is_sqlite(head)) return open_sqlite_bag(path, faults, false);
  if (McapBag::is_mcap(head)) return std::make_unique<McapBag>(std::make_unique<FileBytes>(path), faults);
  throw InputError(fmt::format("{}: is neither SQLite nor MCAP", recorded));
}

/// A ROS 2 recording of one or several files, read one after the other as metadata.yaml lists them. Topics are those of
/// metadata.yaml, too; each file has its own ids for them.
class Ros2Folder : public MessageSource {
 public:
  Ros2Folder(const std::string& folder, Faults& faults);

  const std::vector<Connection>& connections() const override { return metadata_.topics; }
  void select(std::set<std::uint32_t> connections) override {
    selected_ = std::move(connections);
    go_to(0);
  }
  std::optional<Message> next() override;
  void seek(std::int64_t t) override;

 private:
  void go_to(std::size_t file) {
    file_ = file;
    from_.reset();
    reading_ = false;
  }
  bool open_next();
  void open(std::size_t file);
  void select_in(MessageSource& messages);
  bool unpack(Message& message);

  Faults& faults_;
  Ros2Metadata metadata_;
  std::set<std::uint32_t> selected_;
  std::size_t file_ = 0;                 ///< next file to open
  std::optional<std::int64_t> from_;     ///< time sought [ns]
  std::unique_ptr<MessageSource> open_;  ///< stays open until another one is opened: unpacking takes a while
  std::size_t open_file_ = 0;
  std::map<std::string, Faults::Fault> opening_;     ///< faults found when it was opened
  bool reading_ = false;                             ///< the open file
  std::map<std::uint32_t, std::uint32_t> topic_of_;  ///< by the open file's id
  std::vector<std::byte> unpacked_;
};

Ros2Folder::Ros2Folder(const std::string& folder, Faults& faults)
    : faults_(faults), metadata_(read_ros2_metadata(folder)) {
  const std::string first = metadata_.files.front().path;
  std::erase_if(metadata_.files, [&](const Ros2Metadata::File& file) {
    const bool missing = !std::filesystem::is_regular_file(file.path);
    if (missing) faults.add("files of the recording that are missing", file.path);
    return missing;
  });
  if (metadata_.files.empty()) {
    throw InputError(fmt::format("{}: has none of the files that its {} names; expected {}", folder, kMetadata, first));
  }
}

/// False at the end of the recording.
bool Ros2Folder::open_next() {
  while (file_ < metadata_.files.size()) {
    const std::size_t file = file_++;
    try {
      if (!open_ || open_file_ != file) open(file);
      for (const auto& [kind, fault] : opening_) faults_.add(kind, fault.first, fault.count);
      select_in(*open_);
      if (from_) open_->seek(*from_);
      reading_ = true;
      return true;
    } catch (const InputError& error) {
      check_interruption();
      open_.reset();
      faults_.add("files of the recording that can't be read", error.what());
    }
  }
  return false;
}

/// Opens the next file. The faults found are kept apart: they are reported whenever reading of the file begins.
void Ros2Folder::open(std::size_t file) {
  const Faults before = faults_;
  open_.reset();
  faults_.clear();
  try {
    open_ = open_file(metadata_.files[file].path, faults_);
  } catch (const InputError&) {
    faults_ = before;
    throw;
  }
  open_file_ = file;
  opening_ = faults_.all();
  faults_ = before;
}

void Ros2Folder::select_in(MessageSource& messages) {
  std::set<std::uint32_t> chosen;
  topic_of_.clear();
  for (const Connection& there : messages.connections()) {
    bool named = false, taken = false;
    for (const std::uint32_t id : selected_) {
      const Connection& wanted = metadata_.topics[id];
      if (there.topic != wanted.topic) continue;
      named = true;
      if (there.type != wanted.type || !there.readable) continue;
      taken = true;
      topic_of_[there.id] = id;
    }
    if (taken) chosen.insert(there.id);
    if (named && !taken) {
      faults_.add(fmt::format("files whose topics are not as {} says", kMetadata), metadata_.files[file_ - 1].path);
    }
  }
  messages.select(chosen);
}

std::optional<Message> Ros2Folder::next() {
  while (reading_ || open_next()) {
    while (auto message = open_->next()) {
      message->connection = topic_of_.at(message->connection);
      if (unpack(*message)) return message;
    }
    reading_ = false;
  }
  return std::nullopt;
}

/// False if it fails.
bool Ros2Folder::unpack(Message& message) {
  constexpr std::size_t kMostFileBytes = 256 << 20;
  if (!metadata_.messages_compressed) return true;
  if (!decompress_zstd(message.data, kMostFileBytes, unpacked_)) {
    faults_.add("messages that can't be decompressed", metadata_.files[file_ - 1].path);
    return false;
  }
  message.data = unpacked_;
  return true;
}

void Ros2Folder::seek(std::int64_t t) {
  const auto over = [t](const Ros2Metadata::File& file) { return file.end && *file.end < t; };
  std::size_t file = 0;
  while (file < metadata_.files.size() && over(metadata_.files[file])) ++file;
  go_to(file);
  from_ = t;
}

}  // namespace

EventFormat ros2_folder_format() {
  return {"ros2", "ROS 2 recording, a folder with metadata.yaml and SQLite or MCAP files, also compressed by zstd",
          [](const std::string& path, std::span<const std::byte> head) {
            if (!head.empty() || !std::filesystem::is_regular_file(std::filesystem::path(path) / kMetadata))
              return false;
            std::string text(1 << 10, '\0');
            std::ifstream file(std::filesystem::path(path) / kMetadata, std::ios::binary);
            file.read(text.data(), static_cast<std::streamsize>(text.size()));
            return text.find("rosbag2_bagfile_information") != std::string::npos;
          },
          [](const std::string& path, const ReadOptions& options) {
            return read_bag(path, "ROS 2 recording", options,
                            [path](Faults& faults) { return std::make_unique<Ros2Folder>(path, faults); });
          }};
}

}  // namespace evbench
