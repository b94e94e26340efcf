#include "core/events/ros/ros2_metadata.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::uint64_t kMostMetadataBytes = 2 << 20;  ///< in memory it is some hundred times as large at worst

std::optional<std::int64_t> end_of(const YAML::Node& file) {
  const YAML::Node start = file["starting_time"], duration = file["duration"], count = file["message_count"];
  if (!start || !duration || !count || count.as<std::int64_t>() <= 0) return std::nullopt;
  std::int64_t end = 0;
  const bool fits = !__builtin_add_overflow(start["nanoseconds_since_epoch"].as<std::int64_t>(),
                                            duration["nanoseconds"].as<std::int64_t>(), &end);
  return fits ? std::optional(end) : std::nullopt;
}

Ros2Metadata parse(const YAML::Node& recording, const std::string& folder) {
  Ros2Metadata metadata;
  const auto add = [&](const YAML::Node& path, std::optional<std::int64_t> end) {
    const std::string name = std::filesystem::path(path.as<std::string>()).filename().string();
    metadata.files.push_back({(std::filesystem::path(folder) / name).string(), end});
  };
  // With compression by file, only relative_file_paths has the compressed files' names in every version.
  const YAML::Node paths = recording["relative_file_paths"], files = recording["files"];
  for (std::size_t i = 0; i < paths.size(); ++i) {
    add(paths[i], files && files.size() == paths.size() ? end_of(files[i]) : std::nullopt);
  }
  for (const YAML::Node& entry : recording["topics_with_message_count"]) {
    const YAML::Node topic = entry["topic_metadata"];
    metadata.topics.push_back({static_cast<std::uint32_t>(metadata.topics.size()), topic["name"].as<std::string>(),
                               ros::plain_type(topic["type"].as<std::string>()),
                               entry["message_count"].as<std::uint64_t>(),
                               topic["serialization_format"].as<std::string>() == "cdr"});
  }
  const std::string format = recording["compression_format"].as<std::string>(""),
                    mode = recording["compression_mode"].as<std::string>("");
  if (!format.empty() && format != "zstd") {
    throw InputError(fmt::format("{}: is compressed by {}; expected zstd, or nothing", folder, format));
  }
  metadata.messages_compressed = !format.empty() && (mode == "MESSAGE" || mode == "message");
  return metadata;
}

}  // namespace

Ros2Metadata read_ros2_metadata(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "metadata.yaml").string();
  try {
    const YAML::Node recording =
        YAML::Load(read_small_file(path, kMostMetadataBytes, "a description"))["rosbag2_bagfile_information"];
    if (!recording || !recording["relative_file_paths"] || recording["relative_file_paths"].size() == 0) {
      throw InputError(fmt::format("{}: names no files; expected rosbag2_bagfile_information with some", path));
    }
    return parse(recording, folder);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}: is no description of a ROS 2 recording: {}", path, error.what()));
  }
}

}  // namespace evbench
