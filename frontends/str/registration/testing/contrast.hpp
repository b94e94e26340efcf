#pragma once

#include "frontends/str/registration/event_cloud.hpp"
#include "frontends/str/registration/motion_model.hpp"

namespace evbench::str::testing {

/// Variance of the image of a cloud's events, each moved to the reference time by the motion A and spread over the four
/// pixels around it (contrast, Gallego et al. 2018). Events are moved by up to half a pixel at random first, each
/// always by the same offset: on whole pixels, without a lens, zero motion would be a maximum.
double contrast(const EventCloud& cloud, const Matrix3& A, double focal_length);

/// The motion of the highest contrast, by a search along each parameter with decreasing steps; `step`: the first one
/// [1/s]. Simple and slow, for comparison.
MotionParameters maximise_contrast(const EventCloud& cloud, MotionModel model, MotionParameters start, double step,
                                   double focal_length);

}  // namespace evbench::str::testing
