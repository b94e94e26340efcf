#include "core/events/bytes/zip_archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/io/archive.hpp"

namespace evbench {
namespace {

class ArchivedBytes : public ByteSource {
 public:
  /// `file`: of the archive; empty: the path is a compressed file.
  ArchivedBytes(std::string path, std::string file)
      : path_(std::move(path)), file_(std::move(file)), name_(file_.empty() ? path_ : path_ + "/" + file_) {}

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
    archive_ =
        std::make_unique<Archive>(path_, file_.empty() ? Archive::Form::compressed_file : Archive::Form::archive);
    position_ = 0;
    while (archive_->next()) {
      if (file_.empty() || (archive_->kind() == Archive::Kind::file && archive_->name() == file_)) return;
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

std::vector<std::string> ZipArchive::find(const std::string& name) const {
  std::vector<std::string> found;
  std::ranges::copy_if(files_, std::back_inserter(found),
                       [&](const std::string& file) { return file == name || file.ends_with("/" + name); });
  return found;
}

std::unique_ptr<ByteSource> ZipArchive::open(const std::string& file) const {
  return std::make_unique<ArchivedBytes>(path_, file);
}

bool is_compressed_file(std::span<const std::byte> head) {
  using namespace std::string_view_literals;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return std::ranges::any_of(std::initializer_list<std::string_view>{"\x1F\x8B"sv, "BZh"sv,
                                                                     "\xFD"
                                                                     "7zXZ\0"sv,
                                                                     "\x28\xB5\x2F\xFD"sv},
                             [&](std::string_view magic) { return text.starts_with(magic); });
}

std::unique_ptr<ByteSource> open_compressed_file(const std::string& path) {
  return std::make_unique<ArchivedBytes>(path, "");
}

}  // namespace evbench
