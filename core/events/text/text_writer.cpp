#include "core/events/text/text_writer.hpp"

#include <fcntl.h>
#include <fmt/compile.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {

TextWriter::TextWriter(const std::string& path, std::string name, const RecordingHeader& header)
    : name_(std::move(name)), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
  if (file_ < 0) fail();
  const auto out = std::back_inserter(buffer_);
  fmt::format_to(out, "# t[s] x y p\n");
  if (header.width > 0) fmt::format_to(out, "# geometry: {}x{}\n", header.width, header.height);
}

TextWriter::~TextWriter() {
  if (file_ >= 0) ::close(file_);
}

void TextWriter::fail() const {
  const int error = errno;
  check_interruption();  // the write may have waited for a pipe's reader
  throw OutputError(fmt::format("{}: can't be written: {}", name_, std::strerror(error)));
}

void TextWriter::write(std::span<const Event> events) {
  for (const Event& event : events) {
    const std::lldiv_t t = std::lldiv(event.t, 1000000);
    fmt::format_to(std::back_inserter(buffer_), FMT_COMPILE("{}{}.{:06} {} {} {}\n"), event.t < 0 ? "-" : "",
                   std::llabs(t.quot), std::llabs(t.rem), event.x, event.y, event.on ? 1 : 0);
  }
  put_buffer();
}

void TextWriter::put_buffer() {
  for (std::string_view left(buffer_.data(), buffer_.size()); !left.empty();) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0) fail();
    left.remove_prefix(static_cast<std::size_t>(written));
    check_interruption();  // why only a part was written, if a pipe is full
  }
  buffer_.clear();
}

void TextWriter::finish() {
  put_buffer();
  if (::close(std::exchange(file_, -1)) != 0) fail();
}

}  // namespace evbench
