#include "core/events/bytes/zip_archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::size_t kMostFiles = 100'000;

/// libarchive's handle, at one of the archive's entries after the other.
class Entries {
 public:
  explicit Entries(const std::string& path) : path_(path), archive_(archive_read_new(), archive_read_free) {
    constexpr std::size_t kBlock = 1 << 16;
    archive_read_support_format_zip(archive_.get());
    if (archive_read_open_filename(archive_.get(), path.c_str(), kBlock) != ARCHIVE_OK) fail();
  }

  /// The next regular file's name; false at the end.
  bool next(std::string& name) {
    archive_entry* entry = nullptr;
    while (true) {
      const int status = archive_read_next_header(archive_.get(), &entry);
      if (status == ARCHIVE_EOF) return false;
      if (status < ARCHIVE_WARN) fail();
      const char* const found = archive_entry_pathname(entry);
      if (archive_entry_filetype(entry) != AE_IFREG || found == nullptr) continue;
      name = found;
      return true;
    }
  }

  /// Of the current file; 0 at its end.
  std::size_t read(std::span<std::byte> out) {
    const la_ssize_t got = archive_read_data(archive_.get(), out.data(), out.size());
    if (got < 0) fail();
    return static_cast<std::size_t>(got);
  }

 private:
  [[noreturn]] void fail() const {
    const char* const reason = archive_error_string(archive_.get());
    throw InputError(fmt::format("{}: is a broken archive: {}", path_, reason == nullptr ? "no reason given" : reason));
  }

  std::string path_;
  std::unique_ptr<archive, int (*)(archive*)> archive_;
};

class ZipBytes : public ByteSource {
 public:
  ZipBytes(std::string path, std::string file)
      : path_(std::move(path)), file_(std::move(file)), name_(path_ + "/" + file_) {}

  std::uint64_t size() const override { return 0; }
  const std::string& name() const override { return name_; }

  std::size_t read(std::uint64_t offset, std::span<std::byte> out) override {
    if (!entries_ || offset < position_) reopen();
    std::vector<std::byte> passed(std::min<std::uint64_t>(offset - position_, 1 << 16));
    while (position_ < offset) {
      const auto step = std::min<std::uint64_t>(offset - position_, passed.size());
      const std::size_t got = entries_->read(std::span(passed).first(static_cast<std::size_t>(step)));
      if (got == 0) return 0;
      position_ += got;
    }
    std::size_t done = 0;
    while (done < out.size()) {
      const std::size_t got = entries_->read(out.subspan(done));
      if (got == 0) break;
      done += got;
    }
    position_ += done;
    return done;
  }

 private:
  void reopen() {
    entries_ = std::make_unique<Entries>(path_);
    position_ = 0;
    for (std::string found; entries_->next(found);) {
      if (found == file_) return;
    }
    throw InputError(fmt::format("{}: is not there any more", name_));
  }

  std::string path_, file_, name_;
  std::unique_ptr<Entries> entries_;
  std::uint64_t position_ = 0;
};

}  // namespace

ZipArchive::ZipArchive(std::string path) : path_(std::move(path)) {
  Entries entries(path_);
  for (std::string name; entries.next(name);) {
    if (files_.size() == kMostFiles) throw InputError(fmt::format("{}: has more than {} files", path_, kMostFiles));
    files_.push_back(name);
  }
}

std::string ZipArchive::find(const std::string& name) const {
  const auto depth = [](const std::string& file) { return std::count(file.begin(), file.end(), '/'); };
  const std::string* best = nullptr;
  for (const std::string& file : files_) {
    if (file != name && !file.ends_with("/" + name)) continue;
    if (best == nullptr || depth(file) < depth(*best)) best = &file;
  }
  return best == nullptr ? "" : *best;
}

std::unique_ptr<ByteSource> ZipArchive::open(const std::string& file) const {
  return std::make_unique<ZipBytes>(path_, file);
}

}  // namespace evbench
