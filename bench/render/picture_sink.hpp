#pragma once

#include <memory>
#include <string>

#include "bench/render/palette.hpp"

namespace evbench {

/// Output of pictures. The result appears at finish(), and an older file stays until then.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  virtual bool takes_many() const = 0;  ///< false: one picture only
  /// All pictures have the same size.
  virtual void add(const Picture& picture) = 0;
  /// Once, at the end.
  virtual void finish() = 0;
};

/// By the name: NAME.png is one picture, NAME/ a folder of them (000000.png and so on), NAME.mp4 a video (H.264, or
/// MPEG-4 where there is no encoder for that) of `fps` pictures a second.
/// Throws InputError for another name, when the folder that it lies in is missing, and for a folder that holds anything
/// but such pictures.
std::unique_ptr<PictureSink> open_picture_sink(const std::string& path, double fps);

}  // namespace evbench
