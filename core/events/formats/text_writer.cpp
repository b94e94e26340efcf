#include "core/events/formats/text_writer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {

TextWriter::TextWriter(const std::string& path, std::string name)
    : name_(std::move(name)), file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) fail();
}

TextWriter::~TextWriter() {
  if (file_ != nullptr) std::fclose(file_);
}

void TextWriter::fail() const {
  check_interruption();  // it may have waited for a pipe's reader
  throw InputError(fmt::format("{}: can't be written: {}", name_, std::strerror(errno)));
}

void TextWriter::write(std::span<const Event> events) {
  buffer_.clear();
  for (const Event& event : events) {
    const std::lldiv_t t = std::lldiv(event.t, 1000000);
    fmt::format_to(std::back_inserter(buffer_), FMT_COMPILE("{}{}.{:06} {} {} {}\n"), event.t < 0 ? "-" : "",
                   std::llabs(t.quot), std::llabs(t.rem), event.x, event.y, event.on ? 1 : 0);
  }
  if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size()) fail();
}

void TextWriter::finish() {
  std::FILE* const file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0) fail();
}

}  // namespace evbench
