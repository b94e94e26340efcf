#pragma once

#include <optional>

#include "core/geometry/camera.hpp"
#include "core/plugin/exchange.hpp"
#include "frontends/str/registration/motion_model.hpp"

namespace evbench::str {

/// The motion of a model that moves the landmarks in view as the back-end's newest pose and velocity predict. None
/// where the feedback has no velocity, or fewer than eight landmarks.
std::optional<Matrix3> expected_motion(const Feedback& feedback, MotionModel model);

}  // namespace evbench::str
