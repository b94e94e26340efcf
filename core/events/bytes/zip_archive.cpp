#include "core/events/bytes/zip_archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/io/archive.hpp"

namespace evbench {
namespace {

class ZipBytes : public ByteSource {
 public:
  ZipBytes(std::string path, std::string file)
      : path_(std::move(path)), file_(std::move(file)), name_(path_ + "/" + file_) {}

  std::uint64_t size() const override { return 0; }
  const std::string& name() const override { return name_; }

  std::size_t read(std::uint64_t offset, std::span<std::byte> out) override {
    if (!archive_ || offset < position_) reopen();
    std::vector<std::byte> passed(std::min<std::uint64_t>(offset - position_, 1 << 16));
    while (position_ < offset) {
      const auto step = std::min<std::uint64_t>(offset - position_, passed.size());
      const std::size_t got = archive_->read(std::span(passed).first(static_cast<std::size_t>(step)));
      if (got == 0) return 0;
      position_ += got;
    }
    std::size_t done = 0;
    while (done < out.size()) {
      const std::size_t got = archive_->read(out.subspan(done));
      if (got == 0) break;
      done += got;
    }
    position_ += done;
    return done;
  }

 private:
  void reopen() {
    archive_ = std::make_unique<Archive>(path_);
    position_ = 0;
    while (archive_->next()) {
      if (archive_->kind() == Archive::Kind::file && archive_->name() == file_) return;
    }
    throw InputError(fmt::format("{}: is not there any more", name_));
  }

  std::string path_, file_, name_;
  std::unique_ptr<Archive> archive_;
  std::uint64_t position_ = 0;
};

}  // namespace

ZipArchive::ZipArchive(std::string path) : path_(std::move(path)) {
  for (Archive archive(path_); archive.next();) {
    if (archive.kind() == Archive::Kind::file) files_.push_back(archive.name());
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
