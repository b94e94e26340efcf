#pragma once

#include <memory>
#include <string>

#include "bench/render/picture_sink.hpp"

namespace evbench {

/// An MP4 file by OpenCV's FFmpeg. Width and height are made even at the right and the bottom, as encoders want them.
/// add() throws InputError when there is no encoder, finish() when the file is not complete (disk full).
std::unique_ptr<PictureSink> open_video_sink(const std::string& path, double fps);

}  // namespace evbench
