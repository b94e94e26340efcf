#pragma once

#include <memory>

#include "core/events/formats.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// Prophesee RAW: a header that names the encoding ("% evt 3.0", "% format EVT3;height=720;width=1280"), then its
/// words. Each throws InputError for a broken header or another encoding.
std::unique_ptr<EventReader> open_evt2(std::unique_ptr<ByteSource> source, const ReadOptions& options);
std::unique_ptr<EventReader> open_evt21(std::unique_ptr<ByteSource> source, const ReadOptions& options);
std::unique_ptr<EventReader> open_evt3(std::unique_ptr<ByteSource> source, const ReadOptions& options);

/// The format of these three encodings; refuses a RAW file of another encoding by that name.
EventFormat raw_format();

}  // namespace evbench
