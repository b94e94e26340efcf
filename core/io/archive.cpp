#include "core/io/archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <clocale>
#include <utility>

namespace evbench {
namespace {

constexpr int kMostEntries = 1'000'000;

/// Sets this thread's locale to UTF-8 for its lifetime: libarchive converts names to the encoding of the locale.
class Utf8 {
 public:
  Utf8() {
    static const locale_t utf8 = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    if (utf8 != nullptr) before_ = ::uselocale(utf8);
  }
  ~Utf8() {
    if (before_ != nullptr) ::uselocale(before_);
  }
  Utf8(const Utf8&) = delete;
  Utf8& operator=(const Utf8&) = delete;

 private:
  locale_t before_ = nullptr;
};

}  // namespace

Archive::Archive(std::string path, Form form)
    : path_(std::move(path)), archive_(archive_read_new(), archive_read_free) {
  constexpr std::size_t kBlock = 1 << 16;  // [bytes]
  archive_read_support_filter_gzip(archive_.get());
  if (form == Form::compressed_file) {
    archive_read_support_filter_bzip2(archive_.get());
    archive_read_support_filter_xz(archive_.get());
    archive_read_support_filter_zstd(archive_.get());
    archive_read_support_format_raw(archive_.get());
  } else {
    archive_read_support_format_zip(archive_.get());
    archive_read_support_format_tar(archive_.get());
  }
  if (archive_read_open_filename(archive_.get(), path_.c_str(), kBlock) != ARCHIVE_OK) fail();
}

bool Archive::next() {
  const Utf8 names;
  archive_entry* entry = nullptr;
  const int status = archive_read_next_header(archive_.get(), &entry);
  if (status == ARCHIVE_EOF) return false;
  if (status < ARCHIVE_WARN) fail();  // a warning means that a name has no representation in this locale
  if (++entries_ > kMostEntries) throw BadArchive(fmt::format("{}: has more than {} entries", path_, kMostEntries));
  const char* name = archive_entry_pathname_utf8(entry);
  if (name == nullptr) name = archive_entry_pathname(entry);
  if (name == nullptr || *name == '\0') throw BadArchive(fmt::format("{}: has an entry without a name", path_));
  name_ = name;
  const auto type = archive_entry_filetype(entry);
  const bool is_link = archive_entry_hardlink(entry) != nullptr;
  kind_ = is_link ? Kind::other : type == AE_IFREG ? Kind::file : type == AE_IFDIR ? Kind::folder : Kind::other;
  return true;
}

std::size_t Archive::read(std::span<std::byte> out) {
  const la_ssize_t got = archive_read_data(archive_.get(), out.data(), out.size());
  if (got < 0) fail();
  return static_cast<std::size_t>(got);
}

void Archive::fail() const {
  const char* const reason = archive_error_string(archive_.get());
  const std::string where = name_.empty() ? "" : fmt::format(" (entry \"{}\")", name_);
  throw BadArchive(
      fmt::format("{}: is a damaged archive: {}{}", path_, reason != nullptr ? reason : "no reason given", where));
}

}  // namespace evbench
