#pragma once

#include <span>

#include "core/events/event.hpp"
#include "core/geometry/types.hpp"

namespace evbench::poisson {

/// The velocity [px/s] that makes the image of the events around a point sharpest: the largest sum of squares over the
/// pixels of both polarities' images, events carried to the middle of their time (contrast maximisation; Gallego et
/// al., CVPR 2018). Searches displacements over the events' time of 8 px either
/// way along each axis, and around the best one. `radius` [px]. Events in time order.
Vector2 sharpest_velocity(std::span<const Event> events, const Vector2& centre, double radius);

}  // namespace evbench::poisson
