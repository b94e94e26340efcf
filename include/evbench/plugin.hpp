#pragma once

/// \file
/// Everything that a plugin needs: `find_package(evbench)` and `evbench_add_plugin(NAME SOURCES NAME.cpp)`.
///
/// The harness calls a back-end in this order, all times in seconds of the sequence:
///
///     batch 1            batch 2            batch 3
///     ├──────────────────┼──────────────────┼───────▶ time
///     0        z z  z  until₁   z z    z  until₂
///                        │ advance(batch 1), with the observations z up to until₁
///                        │ feedback()  for the front-end, if it uses any
///                                           │ advance(batch 2) ...           finish(), then the queries
///
///     until    the data up to here are in this and the earlier batches
///     seen     ≥ until: how far the front-end had to look into the events to know that
///     horizon  how far a front-end goes in one exchange: FrontEnd::advance(horizon, batch)
///
/// A back-end of ten lines, the camera at rest:
///
///     #include <evbench/plugin.hpp>
///     using namespace evbench;
///     struct AtRest : BackEnd {
///       struct Options { void declare(OptionSet&) {} };
///       AtRest(const Options&, const BackEndContext&) {}
///       void advance(const UndistortedBatch& batch) override { poses.push_back({batch.until, SE3()}); }
///       void finish() override {}
///       PoseTrajectory trajectory() const override { return PoseTrajectory(poses); }
///       std::vector<StampedPose> poses;
///     };
///     const Registration<BackEnd, AtRest> registration("at_rest", "a camera at rest", 1);
///
/// Front-ends of events derive from EventFrontEnd, of anything else from FrontEnd; sources from Source.

#include "core/events/event_front_end.hpp"
#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/frontend.hpp"
#include "core/plugin/registration.hpp"
#include "core/plugin/source.hpp"
#include "core/plugin/track_player.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/plugin/undistort.hpp"
#include "core/simulation/random.hpp"
#include "core/structure/depth_reversal.hpp"
#include "core/structure/initialiser.hpp"
#include "core/structure/track_buffer.hpp"
#include "core/structure/triangulation.hpp"
#include "core/support/error.hpp"
#include "core/support/median.hpp"
#include "core/support/seconds_since.hpp"
