#include "core/io/zip.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <memory>

#include "core/support/error.hpp"

namespace evbench {
namespace {

la_ssize_t append(archive* /*writer*/, void* bytes, const void* data, std::size_t size) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), size);
  return static_cast<la_ssize_t>(size);
}

void check(archive* writer, la_ssize_t status) {
  if (status < ARCHIVE_OK) throw OutputError(fmt::format("a zip can't be made: {}", archive_error_string(writer)));
}

}  // namespace

std::string zip(std::span<const std::pair<std::string, std::string>> files) {
  std::string bytes;
  const std::unique_ptr<archive, int (*)(archive*)> writer(archive_write_new(), archive_write_free);
  check(writer.get(), archive_write_set_format_zip(writer.get()));
  check(writer.get(), archive_write_set_bytes_in_last_block(writer.get(), 1));
  check(writer.get(), archive_write_open(writer.get(), &bytes, nullptr, append, nullptr));
  for (const auto& [name, content] : files) {
    const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 315619200, 0);  // 1980-01-02, close to the earliest date of a zip
    check(writer.get(), archive_write_header(writer.get(), entry.get()));
    check(writer.get(), archive_write_data(writer.get(), content.data(), content.size()));
  }
  check(writer.get(), archive_write_close(writer.get()));
  return bytes;
}

}  // namespace evbench
