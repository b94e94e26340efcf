#include "core/events/native/keeping_reader.hpp"

#include <filesystem>

#include "core/support/error.hpp"

namespace evbench {

KeepingReader::KeepingReader(std::unique_ptr<EventReader> reader, const std::string& path)
    : reader_(std::move(reader)), path_(path) {
  begin();
}

void KeepingReader::begin() {
  RecordingHeader header;
  header.width = info().width;
  header.height = info().height;
  file_ = std::make_unique<PartFile>(path_);
  writer_ = std::make_unique<NativeWriter>(file_->writable_path(), header, path_);
  begun_ = false;
}

void KeepingReader::give_up() {
  writer_.reset();
  file_.reset();
}

bool KeepingReader::read(std::vector<Event>& events) {
  const bool more = reader_->read(events);
  begun_ = true;
  if (!writer_) return more;
  try {
    if (more) {
      writer_->write(events);
    } else {
      writer_->finish();
      file_->commit();
      give_up();
    }
  } catch (const OutputError&) {
    give_up();
  }
  return more;
}

void KeepingReader::seek(std::int64_t t) {
  reader_->seek(t);
  if (t <= 0 && (!begun_ || writer_)) {
    try {
      if (begun_) begin();
    } catch (const OutputError&) {
      give_up();
    }
  } else {
    give_up();
  }
}

std::unique_ptr<EventReader> read_or_keep(const std::string& path,
                                          const std::function<std::unique_ptr<EventReader>()>& make) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return std::make_unique<NativeReader>(path);
  std::unique_ptr<EventReader> reader = make();
  return reader ? std::make_unique<KeepingReader>(std::move(reader), path) : std::move(reader);
}

}  // namespace evbench
