#include "core/events/hdf5/trial.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"
#include "core/support/trial.hpp"

namespace evbench::hdf5 {
namespace {

void look_through(EventReader& reader) {
  constexpr std::int64_t kPlaces = 8;
  const std::int64_t start = reader.info().start.value_or(0), end = reader.info().end.value_or(0);
  std::vector<Event> events;
  for (std::int64_t i = 0; i <= kPlaces; ++i) {
    reader.seek(start + (end / kPlaces - start / kPlaces) * i);
    reader.read(events);
  }
  reader.ground_truth();
  reader.calibration();
}

}  // namespace

void refuse_crashes(const std::string& path, const std::function<std::unique_ptr<EventReader>()>& open) {
  constexpr unsigned kMostSeconds = 10;
  const std::string end = trial([&] { look_through(*open()); }, kMostSeconds);
  if (end.empty()) return;
  throw InputError(
      fmt::format("{}: is broken in a way that the HDF5 library cannot read; reading it ended with: {}", path, end));
}

}  // namespace evbench::hdf5
