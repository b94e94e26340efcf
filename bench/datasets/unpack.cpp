#include "bench/datasets/unpack.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/support/interruption.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 1 << 20;  // [bytes]
constexpr int kMaxEntries = 1000000;

/// Names in archives are UTF-8, whatever the user's locale is: libarchive converts them by the thread's.
class Utf8Locale {
 public:
  Utf8Locale() : utf8_(::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr)) {
    if (utf8_ != nullptr) before_ = ::uselocale(utf8_);
  }
  ~Utf8Locale() {
    if (utf8_ == nullptr) return;
    ::uselocale(before_);
    ::freelocale(utf8_);
  }
  Utf8Locale(const Utf8Locale&) = delete;
  Utf8Locale& operator=(const Utf8Locale&) = delete;

 private:
  locale_t utf8_, before_ = nullptr;
};

class Unpacker {
 public:
  Unpacker(const std::string& path, const std::string& folder, std::uint64_t limit)
      : path_(path), folder_(folder), left_(limit), archive_(archive_read_new(), archive_read_free), block_(kBlock) {
    archive_read_support_format_zip(archive_.get());
    archive_read_support_format_tar(archive_.get());
    archive_read_support_filter_gzip(archive_.get());
    if (archive_read_open_filename(archive_.get(), path.c_str(), kBlock) != ARCHIVE_OK) fail(message());
  }

  void run() {
    archive_entry* entry = nullptr;
    for (int count = 0;; ++count) {
      const int result = archive_read_next_header(archive_.get(), &entry);
      if (result == ARCHIVE_EOF) return;
      if (result < ARCHIVE_WARN) fail(message());  // a warning is of a name that this locale has no characters for
      if (count == kMaxEntries) fail(fmt::format("has more than {} entries", kMaxEntries));
      extract(entry);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw BadArchive(fmt::format("{}: {}", path_, message)); }
  [[noreturn]] void fail_writing(const std::string& name, int error) const {
    throw InputError(fmt::format("{}: the entry \"{}\" can't be written: {}", path_, name, std::strerror(error)));
  }
  std::string message() const {
    const char* const text = archive_error_string(archive_.get());
    return fmt::format("is a damaged archive: {}", text != nullptr ? text : "unknown error");
  }

  std::string name_of(archive_entry* entry) const {
    const char* name = archive_entry_pathname_utf8(entry);
    if (name == nullptr) name = archive_entry_pathname(entry);
    if (name == nullptr || *name == '\0') fail("has an entry without a name");
    const fs::path path(name);
    bool leads_out = path.is_absolute() || path.string().find('\\') != std::string::npos;
    for (const fs::path& part : path) leads_out |= part == "..";
    if (leads_out) fail(fmt::format("the entry \"{}\" leads out of the folder: refused", name));
    return name;
  }

  void extract(archive_entry* entry) {
    const std::string name = name_of(entry);
    const auto type = archive_entry_filetype(entry);
    if ((type != AE_IFREG && type != AE_IFDIR) || archive_entry_hardlink(entry) != nullptr) {
      fail(fmt::format("the entry \"{}\" is a link or device: refused", name));
    }
    const fs::path target = fs::path(folder_) / name;
    std::error_code error;
    fs::create_directories(type == AE_IFDIR ? target : target.parent_path(), error);
    if (error) fail_writing(name, error.value());
    if (type == AE_IFREG) extract_file(name, target);
  }

  void extract_file(const std::string& name, const fs::path& target) {
    if (fs::exists(target)) fail(fmt::format("the entry \"{}\" is there twice", name));
    const std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::fopen(target.c_str(), "wb"), std::fclose);
    if (!file) fail_writing(name, errno);
    while (const la_ssize_t got = archive_read_data(archive_.get(), block_.data(), block_.size())) {
      if (got < 0) fail(fmt::format("{} (entry \"{}\")", message(), name));
      const auto size = static_cast<std::size_t>(got);
      if (size > left_) fail(fmt::format("unpacks to more than the catalogue allows, at entry \"{}\"", name));
      left_ -= size;
      if (std::fwrite(block_.data(), 1, size, file.get()) != size) fail_writing(name, errno);
      check_interruption();
    }
    if (std::fflush(file.get()) != 0) fail_writing(name, errno);
  }

  std::string path_, folder_;
  std::uint64_t left_;  // [bytes]
  std::unique_ptr<archive, decltype(&archive_read_free)> archive_;
  std::vector<char> block_;
};

/// Where the folder holds one folder and nothing else, that one's content takes its place.
void lift_single_folder(const std::string& folder) {
  std::vector<fs::directory_entry> entries{fs::directory_iterator(folder), fs::directory_iterator()};
  if (entries.size() != 1 || !entries[0].is_directory()) return;
  const fs::path aside = folder + ".lifted";  // a file in it may have its name
  fs::rename(entries[0].path(), aside);
  fs::remove(folder);
  fs::rename(aside, folder);
}

}  // namespace

void unpack(const std::string& archive, const std::string& folder, std::uint64_t limit) {
  const Utf8Locale locale;
  Unpacker(archive, folder, limit).run();
  lift_single_folder(folder);
}

}  // namespace evbench
