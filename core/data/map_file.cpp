#include "core/data/map_file.hpp"

#include <fmt/format.h>

#include "core/io/text_reader.hpp"

namespace evbench {

std::string format_map(std::span<const Landmark> map) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment landmarks in the back-end's world frame\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nproperty int64 track\nend_header\n",
      map.size());
  for (const Landmark& l : map) {
    text += fmt::format("{:.9g} {:.9g} {:.9g} {}\n", l.position.x(), l.position.y(), l.position.z(), l.track);
  }
  return text;
}

std::vector<Landmark> read_map(const std::string& path) {
  TextReader reader(path);
  if (!reader.next() || reader.text() != "ply") reader.fail("expected a PLY file, whose first line is \"ply\"");
  while (reader.text() != "end_header") {
    if (!reader.next()) reader.fail("has no end_header");
  }
  std::vector<Landmark> map;
  while (reader.next()) {
    reader.expect_columns(4, "x y z track");
    const double x = reader.number(0, "x"), y = reader.number(1, "y"), z = reader.number(2, "z");
    map.push_back({reader.integer(3, "the track"), {x, y, z}});
  }
  return map;
}

}  // namespace evbench
