#include "core/events/recording_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "core/support/error.hpp"

namespace evbench {
namespace {

/// Names of events in a recording's folder, in order of precedence: evbench's native copy, the Event-Camera Dataset,
/// EDS, DSEC as unpacked in two ways, TUM-VIE, M3ED, MVSEC.
constexpr const char* kEventFiles[] = {"events.evb",     "events.txt",      "events.h5", "events/left/events.h5",
                                       "left/events.h5", "*events_left.h5", "*_data.h5", "*_data.hdf5"};

bool is_zip(std::span<const std::byte> head) {
  return std::string_view(reinterpret_cast<const char*>(head.data()), head.size()).starts_with("PK\3\4");
}

std::array<std::byte, 8> read_first_bytes(const std::string& path) {
  std::array<std::byte, 8> head{};
  FileBytes(path).read(0, head);
  return head;
}

[[noreturn]] void fail_for_several(const std::string& path, const std::vector<std::string>& names) {
  throw InputError(fmt::format("{}: holds several recordings ({}); expected one: {}", path, fmt::join(names, ", "),
                               path.ends_with('/') ? "name the file" : "unpack it, and name a folder"));
}

/// With a trailing slash.
std::string folder_of(const std::string& file) {
  const auto slash = file.rfind('/');
  return slash == std::string::npos ? "" : file.substr(0, slash + 1);
}

/// Removes this last part of a folder's path; false, and nothing is removed, if the last part is another.
bool leave(std::string& folder, const std::string& last) {
  const std::string end = last + "/";
  if (folder != end && !folder.ends_with("/" + end)) return false;
  folder.resize(folder.size() - end.size());
  return true;
}

/// The folder of the recording that a file of events belongs to, with a trailing slash: the folder of the file but for
/// events/left/events.h5 and left/events.h5.
std::string recording_of(const std::string& file) {
  std::string folder = folder_of(file);
  if (file.substr(folder.size()) == "events.h5" && (leave(folder, "left") || leave(folder, "right"))) {
    leave(folder, "events");
  }
  return folder;
}

/// A file in memory with a path.
class MemoryFile {
 public:
  explicit MemoryFile(ByteSource& content) : descriptor_(::memfd_create("evbench", MFD_CLOEXEC)) {
    constexpr std::size_t kMost = std::size_t{1} << 26, kPiece = 1 << 16;
    if (descriptor_ < 0) throw InputError(fmt::format("{}: can't be unpacked into memory", content.name()));
    std::vector<std::byte> piece(kPiece);
    for (std::size_t size = 0, got = 0; (got = content.read(size, piece)) > 0; size += got) {
      if (size + got > kMost) throw InputError(fmt::format("{}: has more than {} bytes", content.name(), kMost));
      if (::write(descriptor_, piece.data(), got) != static_cast<ssize_t>(got)) {
        throw InputError(fmt::format("{}: can't be unpacked into memory", content.name()));
      }
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

RecordingFiles::RecordingFiles(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    folder_ = path + "/";
  } else if (is_zip(read_first_bytes(path))) {
    archive_.emplace(path);
    const std::vector<std::string> found = archive_->find("events.txt");
    if (found.empty()) throw InputError(fmt::format("{}: has no events.txt among its files", path));
    if (found.size() > 1) fail_for_several(path, found);
    events_ = found.front();
    folder_ = folder_of(events_);
  } else {
    events_ = path;
    folder_ = recording_of(path);
  }
}

std::string RecordingFiles::events() const {
  if (archive_) return archive_->path();
  if (!events_.empty()) return events_;
  for (const char* pattern : kEventFiles) {
    const auto names = matching(pattern);
    if (names.size() > 1) fail_for_several(folder_, names);
    if (!names.empty()) return path(names.front());
  }
  return "";
}

bool RecordingFiles::has(const std::string& name) const {
  if (!archive_) return std::filesystem::is_regular_file(folder_ + name);
  return std::find(archive_->files().begin(), archive_->files().end(), folder_ + name) != archive_->files().end();
}

std::vector<std::string> RecordingFiles::matching(const std::string& pattern) const {
  const std::string within = folder_of(pattern);
  std::vector<std::string> names;
  const auto consider = [&](const std::string& name) {
    if (::fnmatch(pattern.c_str(), name.c_str(), FNM_PATHNAME) == 0) names.push_back(name);
  };
  std::error_code error;
  if (archive_) {
    for (const std::string& file : archive_->files()) {
      if (file.starts_with(folder_)) consider(file.substr(folder_.size()));
    }
  } else if (pattern.find('*') == std::string::npos) {
    if (has(pattern)) names.push_back(pattern);
  } else {
    const std::string folder = folder_ + within;
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, error)) {
      if (entry.is_regular_file(error)) consider(within + entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string RecordingFiles::path(const std::string& name) const {
  return archive_ ? archive_->path() + "/" + folder_ + name : folder_ + name;
}

std::unique_ptr<ByteSource> RecordingFiles::open(const std::string& name) const {
  if (archive_) return archive_->open(folder_ + name);
  return std::make_unique<FileBytes>(folder_ + name);
}

std::unique_ptr<ByteSource> RecordingFiles::open_events() const {
  if (archive_) return archive_->open(events_);
  const std::string path = events();
  if (is_compressed_file(read_first_bytes(path))) return open_compressed_file(path);
  return std::make_unique<FileBytes>(path);
}

void RecordingFiles::read(const std::string& name, const std::function<void(const std::string& path)>& read) const {
  if (!archive_) return read(folder_ + name);
  const auto content = open(name);
  const MemoryFile file(*content);
  try {
    read(file.path());
  } catch (const InputError& error) {
    std::string message = error.what();
    if (const auto at = message.find(file.path()); at != std::string::npos) {
      message.replace(at, file.path().size(), content->name());
    }
    throw InputError(message);
  }
}

}  // namespace evbench
