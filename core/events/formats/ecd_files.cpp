#include "core/events/formats/ecd_files.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "core/support/error.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEvents = "events.txt";
constexpr const char* kOthers[] = {"calib.txt", "groundtruth.txt", "images.txt", "imu.txt"};

bool is_zip(const std::string& path) {
  std::array<std::byte, 4> head{};
  FileBytes(path).read(0, head);
  return std::string_view(reinterpret_cast<const char*>(head.data()), head.size()) == std::string_view("PK\3\4", 4);
}

/// With the slash.
std::string folder_of(const std::string& file) {
  const auto slash = file.rfind('/');
  return slash == std::string::npos ? "" : file.substr(0, slash + 1);
}

/// A file in memory that has a path.
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

EcdFiles::EcdFiles(const std::string& path) {
  if (fs::is_directory(path)) {
    folder_ = path + "/";
    events_ = folder_ + kEvents;
  } else if (is_zip(path)) {
    archive_.emplace(path);
    events_ = archive_->find(kEvents);
    if (events_.empty()) throw InputError(fmt::format("{}: has no {} among its files", path, kEvents));
    folder_ = folder_of(events_);
  } else {
    events_ = path;
    folder_ = folder_of(path);
  }
  for (const char* name : kOthers) {
    if (exists(folder_ + name) && folder_ + name != events_) others_.emplace_back(name);
  }
}

bool EcdFiles::exists(const std::string& file) const {
  if (!archive_) return fs::is_regular_file(file);
  return std::find(archive_->files().begin(), archive_->files().end(), file) != archive_->files().end();
}

std::unique_ptr<ByteSource> EcdFiles::open(const std::string& file) const {
  if (archive_) return archive_->open(file);
  return std::make_unique<FileBytes>(file);
}

std::unique_ptr<ByteSource> EcdFiles::open_events() const { return open(events_); }

bool EcdFiles::has(const std::string& name) const {
  return std::find(others_.begin(), others_.end(), name) != others_.end();
}

void EcdFiles::read(const std::string& name, const std::function<void(const std::string& path)>& read) const {
  if (!archive_) return read(folder_ + name);
  const auto content = open(folder_ + name);
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

std::string EcdFiles::first_picture() const {
  const std::string images = folder_ + "images/";
  std::string first;
  const auto consider = [&](const std::string& file) {
    if (file.starts_with(images) && file.ends_with(".png") && (first.empty() || file < first)) first = file;
  };
  if (archive_) {
    for (const std::string& file : archive_->files()) consider(file);
  } else if (fs::is_directory(images)) {
    for (const auto& entry : fs::directory_iterator(images)) consider(entry.path().string());
  }
  return first;
}

std::optional<std::pair<int, int>> EcdFiles::picture_size() const {
  // PNG: signature, then the header's length and name, width and height, big-endian.
  constexpr std::string_view kSignature("\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR", 16);
  constexpr int kLargest = 65535;
  const std::string picture = first_picture();
  if (picture.empty()) return std::nullopt;
  std::array<std::byte, 24> head{};
  open(picture)->read(0, head);
  if (std::string_view(reinterpret_cast<const char*>(head.data()), kSignature.size()) != kSignature)
    return std::nullopt;
  const auto side = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint32_t>(head[at + i]);
    return value >= 1 && value <= kLargest ? static_cast<int>(value) : 0;
  };
  if (side(16) == 0 || side(20) == 0) return std::nullopt;
  return std::pair(side(16), side(20));
}

}  // namespace evbench
