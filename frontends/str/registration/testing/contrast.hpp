#pragma once

#include "frontends/str/registration/event_cloud.hpp"
#include "frontends/str/registration/motion_model.hpp"

namespace evbench::str::testing {

/// Variance of the image of a cloud's events, each moved to the reference time by the motion A and spread over the four
/// pixels around it (contrast, Gallego et al. 2018). Events are moved by up to half a pixel at random first, each
/// always the same way: on whole pixels, without a lens, no motion at all would be a maximum.
double contrast(const EventCloud& cloud, const Matrix3& A, double focal_length);

/// The motion whose contrast is highest, by a search along each parameter with steps that become smaller; `step`: the
/// first one [1/s]. Plain and slow: to compare with.
MotionParameters maximise_contrast(const EventCloud& cloud, MotionModel model, MotionParameters start, double step,
                                   double focal_length);

}  // namespace evbench::str::testing
