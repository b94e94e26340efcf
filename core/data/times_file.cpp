#include "core/data/times_file.hpp"

#include <fmt/format.h>

#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {

std::vector<double> read_times(const std::string& path) {
  std::vector<double> times;
  TextReader reader(path);
  while (reader.next()) times.push_back(reader.number(0, "the time"));
  if (times.empty()) throw InputError(fmt::format("{}: holds no time; expected one a line", path));
  return times;
}

}  // namespace evbench
