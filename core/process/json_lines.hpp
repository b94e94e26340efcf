#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/landmark.hpp"
#include "core/events/event.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/exchange.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/status.hpp"
#include "core/support/json.hpp"

// Writes and reads the messages of docs/reference/process_protocol.md, one JSON object a line. Numbers are written in
// the shortest form that reads back as the same number.

namespace evbench::process {

/// An invalid message: what() names the place in it, what was found and what was expected.
class MessageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Writing.

using Line = fmt::memory_buffer;

/// [[t, x, y, p], ...], t in seconds.
void write_events(Line& line, std::span<const Event> events);

/// Writes "until": ..., "observations": ..., "ended": ...; leaves out values that are not finite and returns their
/// number.
int write_batch(Line& line, const UndistortedBatch& batch);

/// One feedback as an object.
void write_feedback(Line& line, const Feedback& feedback);

// Reading. Each function throws MessageError.

/// Parses a line as a JSON object.
Json parse_object(const std::string& line);

/// Throws for an unknown key, with the nearest known one.
void check_keys(const Json& object, const std::vector<std::string>& known);

/// The value of a key; nullptr if it is missing. require() throws instead.
const Json* find(const Json& object, const char* key);
const Json& require(const Json& object, const char* key);

/// Place of a value: the key and the index in its list.
struct Place {
  const char* key;
  std::optional<std::size_t> index = {};
  std::string text() const;
};

double number(const Json& value, const Place& place);  ///< finite
std::int64_t integer(const Json& value, const Place& place);
std::string text(const Json& value, const Place& place);
const Json& list(const Json& value, const Place& place);

/// A list of finite numbers, as many as `names` has words ("t px py pz qx qy qz qw").
std::vector<double> numbers(const Json& value, const char* names, const Place& place);

/// [t, px, py, pz, qx, qy, qz, qw], T_world_camera; the quaternion's norm may be off by a thousandth.
StampedPose pose(const Json& value, const Place& place);

/// A list of those, times strictly increasing.
std::vector<StampedPose> poses(const Json& value, const char* key);

/// [t, px ... qw] or [t, px ... qw, ωx, ωy, ωz, νx, νy, νz]; without the last six, the velocity is none.
struct MovingPose {
  StampedPose pose;
  std::optional<Vector6> velocity;
};
MovingPose moving_pose(const Json& value, const Place& place);

TrackingState tracking_state(const Json& value);
RunState run_state(const Json& value);
std::string name_of(TrackingState state);
Matrix12 covariance(const Json& value);                                ///< 144 numbers, symmetric
std::vector<UndistortedFeature> expected_features(const Json& value);  ///< [[track, x, y, z, u, v, Σuu, Σuv, Σvv]]
/// [[track, t, u, v, sigma]] in time order. `covariances`: [[xx, xy, yy]] of each, instead of sigma, or null.
std::vector<TrackObservation> observations(const Json& value, const Json* covariances = nullptr);
std::vector<TrackEnd> track_ends(const Json& value);          ///< [[track, t]], time order
std::vector<Landmark> landmarks(const Json& value);           ///< [[track, x, y, z]]
std::vector<DegradedSpan> degraded_spans(const Json& value);  ///< [[from, to, reason]]

}  // namespace evbench::process
