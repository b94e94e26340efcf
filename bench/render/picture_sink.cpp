#include "bench/render/picture_sink.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "bench/render/video_sink.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

std::string encode_png(const Picture& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

class FileSink : public PictureSink {
 public:
  explicit FileSink(std::string path) : path_(std::move(path)) {}
  bool takes_many() const override { return false; }
  void add(const Picture& picture) override { png_ = encode_png(picture); }
  void finish() override { write_file(path_, png_); }

 private:
  std::string path_, png_;
};

std::string picture_name(std::int64_t number) { return fmt::format("{:06}.png", number); }

class FolderSink : public PictureSink {
 public:
  explicit FolderSink(const std::string& path) : folder_(path) {}
  bool takes_many() const override { return true; }
  void add(const Picture& picture) override { folder_.write(picture_name(count_++), encode_png(picture)); }
  void finish() override { folder_.commit(); }

 private:
  AtomicFolder folder_;
  std::int64_t count_ = 0;
};

/// Only rendered pictures may be replaced: 000000.png and so on.
void check_replaceable(const std::string& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_number = name.find_first_not_of("0123456789") == name.size() - 4;
    if (entry.is_regular_file() && name.size() >= picture_name(0).size() && name.ends_with(".png") && is_number)
      continue;
    throw InputError(fmt::format(
        "{}: holds {}; expected a new folder, or one with nothing but rendered pictures, which are replaced", folder,
        name));
  }
}

void check_parent(const std::string& path) {
  fs::path parent = fs::path(path).parent_path();
  if (parent.empty()) parent = ".";
  if (!fs::is_directory(parent)) throw InputError(fmt::format("{}: the folder {} is missing", path, parent.string()));
}

}  // namespace

std::unique_ptr<PictureSink> open_picture_sink(const std::string& path, double fps) {
  const std::string extension = fs::path(path).extension().string();
  if (path.ends_with('/') || fs::is_directory(path)) {
    std::string name = path;
    while (name.size() > 1 && name.ends_with('/')) name.pop_back();
    check_parent(name);
    if (fs::is_directory(name)) check_replaceable(name);
    return std::make_unique<FolderSink>(name);
  }
  if (extension == ".png" || extension == ".mp4") check_parent(path);
  if (extension == ".png") return std::make_unique<FileSink>(path);
  if (extension == ".mp4") return open_video_sink(path, fps);
  throw InputError(
      fmt::format("{}: ends in \"{}\"; expected .png (a picture), .mp4 (a video) or / (a folder of "
                  "pictures)",
                  path, extension));
}

}  // namespace evbench
