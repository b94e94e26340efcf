#include "backends/gp_map/modules/map_check.hpp"

namespace evbench::gp_map {

void MapCheck::follow(const TrackTable& tracks, bool searched) {
  if (searched && tracks.mismatched() <= tracks.landmarks_in_view()) confirmed_ = true;
}

}  // namespace evbench::gp_map
