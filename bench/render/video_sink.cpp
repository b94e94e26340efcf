#include "bench/render/video_sink.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/videoio.hpp>

#include "core/io/part_file.hpp"
#include "core/io/temporary_file.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// A temporary second name of a file, with the extension by which FFmpeg chooses the container.
class NameWithExtension {
 public:
  NameWithExtension(const std::string& target, const std::string& extension) : extension_(extension) {
    std::string folder = temporary_folder() + "/evbench-XXXXXX";
    if (::mkdtemp(folder.data()) == nullptr) throw OutputError(fmt::format("{}: can't be made", folder));
    folder_ = folder;
    fs::create_symlink(fs::absolute(target), path());
  }
  ~NameWithExtension() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  NameWithExtension(const NameWithExtension&) = delete;
  NameWithExtension& operator=(const NameWithExtension&) = delete;

  std::string path() const { return (folder_ / ("out" + extension_)).string(); }

 private:
  fs::path folder_;
  std::string extension_;
};

class VideoSink : public PictureSink {
 public:
  VideoSink(const std::string& path, double fps) : path_(path), fps_(fps), file_(path) {}
  bool takes_many() const override { return true; }

  void add(const Picture& picture) override {
    Picture even;
    cv::copyMakeBorder(picture, even, 0, picture.rows % 2, 0, picture.cols % 2, cv::BORDER_REPLICATE);
    if (!writer_.isOpened()) open(even.size());
    writer_.write(even);
    ++count_;
  }

  void finish() override {
    writer_.release();
    // The writer reports no errors: the file is read back to check that it has all its pictures.
    cv::VideoCapture written(file_.writable_path(), cv::CAP_FFMPEG);
    const bool complete = written.isOpened() && std::lround(written.get(cv::CAP_PROP_FRAME_COUNT)) == count_;
    written.release();
    if (!complete) throw OutputError(fmt::format("{}: the video could not be written completely (disk full?)", path_));
    file_.commit();
  }

 private:
  void open(cv::Size size) {
    const NameWithExtension name(file_.writable_path(), ".mp4");
    for (const char* codec : {"avc1", "mp4v"}) {
      const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
      if (writer_.open(name.path(), cv::CAP_FFMPEG, fourcc, fps_, size)) return;
    }
    throw InputError(
        fmt::format("{}: this machine's OpenCV can't encode MP4 (neither H.264 nor MPEG-4) of {}x{} pixels; "
                    "expected .png or a folder",
                    path_, size.width, size.height));
  }

  std::string path_;
  double fps_;
  PartFile file_;
  cv::VideoWriter writer_;
  std::int64_t count_ = 0;
};

}  // namespace

std::unique_ptr<PictureSink> open_video_sink(const std::string& path, double fps) {
  return std::make_unique<VideoSink>(path, fps);
}

}  // namespace evbench
