#include "bench/datasets/unpack.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/io/archive.hpp"
#include "core/io/file_handle.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

class Unpacker {
 public:
  Unpacker(const std::string& path, const std::string& folder, std::uint64_t limit)
      : path_(path), folder_(folder), left_(limit), archive_(path) {}

  void run() {
    while (archive_.next()) extract();
  }

 private:
  /// `what`: of the current entry.
  [[noreturn]] void refuse(const std::string& what) const {
    throw BadArchive(fmt::format("{}: the entry \"{}\" {}", path_, archive_.name(), what));
  }
  [[noreturn]] void fail_writing(int error) const {
    throw InputError(
        fmt::format("{}: the entry \"{}\" can't be written: {}", path_, archive_.name(), std::strerror(error)));
  }

  void extract() {
    const fs::path name(archive_.name());
    bool leads_out = name.is_absolute() || archive_.name().find('\\') != std::string::npos;
    for (const fs::path& part : name) leads_out |= part == "..";
    if (leads_out) refuse("leads out of the folder: refused");
    if (archive_.kind() == Archive::Kind::other) refuse("is a link or device: refused");
    const bool is_folder = archive_.kind() == Archive::Kind::folder;
    const fs::path target = fs::path(folder_) / name;
    std::error_code error;
    fs::create_directories(is_folder ? target : target.parent_path(), error);
    if (error) fail_writing(error.value());
    if (!is_folder) extract_file(target);
  }

  void extract_file(const fs::path& target) {
    if (fs::exists(target)) refuse("is there twice");
    const auto close = [](std::FILE* open) { std::fclose(open); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(target.c_str(), "wb"), close);
    if (!file) fail_writing(errno);
    while (const std::size_t size = archive_.read(block_)) {
      if (size > left_) refuse("unpacks to more than the catalogue allows");
      left_ -= size;
      if (std::fwrite(block_.data(), 1, size, file.get()) != size) fail_writing(errno);
      check_interruption();
    }
    if (std::fflush(file.get()) != 0) fail_writing(errno);
  }

  std::string path_, folder_;
  std::uint64_t left_;  ///< [bytes]
  Archive archive_;
  std::vector<std::byte> block_ = std::vector<std::byte>(1 << 20);
};

/// Where the folder holds only one folder, replaces that folder by its content.
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
  Unpacker(archive, folder, limit).run();
  lift_single_folder(folder);
}

}  // namespace evbench
