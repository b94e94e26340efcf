#include "core/data/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/data/pose_record.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

/// A record with its own index or with a reference to one, and its line.
template <class Value>
struct Indexed {
  int index;
  std::int64_t line;
  Value value;
};

class ProblemReader {
 public:
  explicit ProblemReader(const std::string& path) : path_(path), reader_(path) {}

  Problem read() {
    while (reader_.next()) record();
    if (!has_camera_) fail("has no CAM record");
    if (!has_qc_) fail("has no QC record");
    if (states_.empty()) fail("has no STATE record");
    problem_.states = in_sequence(states_, "STATE");
    problem_.landmarks = in_sequence(landmarks_, "LM");
    check_times();
    check_references(landmark_references_, problem_.landmarks.size(), "landmark");
    check_references(state_references_, problem_.states.size(), "state");
    return std::move(problem_);
  }

 private:
  struct Reference {
    int index;
    std::int64_t line;
  };

  std::string path_;
  TextReader reader_;
  Problem problem_;
  bool has_camera_ = false, has_qc_ = false;
  std::vector<Indexed<ControlState>> states_;
  std::vector<Indexed<Vector3>> landmarks_;
  std::vector<Reference> landmark_references_, state_references_;

  [[noreturn]] void fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", path_, message)); }
  [[noreturn]] void fail(std::int64_t line, const std::string& message) const {
    throw InputError(fmt::format("{}:{}: {}", path_, line, message));
  }

  int index(std::size_t column) const {
    const std::int64_t value = reader_.integer(column, "the index");
    if (value < 0 || value > std::numeric_limits<int>::max()) {
      reader_.fail(fmt::format("the index is {}; expected 0, 1, 2, ...", value));
    }
    return static_cast<int>(value);
  }

  Reference reference(std::size_t column) const { return {index(column), reader_.line()}; }

  double positive(std::size_t column, const char* what) const {
    const double value = reader_.number(column, what);
    if (!(value > 0.0)) reader_.fail(fmt::format("{} is {}; expected > 0", what, value));
    return value;
  }

  Vector6 vector6(std::size_t first, const char* what) const {
    Vector6 v;
    for (Eigen::Index i = 0; i < 6; ++i) v[i] = reader_.number(first + static_cast<std::size_t>(i), what);
    return v;
  }

  Vector6 positive6(std::size_t first, const char* what) const {
    Vector6 v;
    for (Eigen::Index i = 0; i < 6; ++i) v[i] = positive(first + static_cast<std::size_t>(i), what);
    return v;
  }

  Vector3 vector3(std::size_t first) const { return read_vector3(reader_, consecutive<3>(first), "the position"); }

  SE3 pose(std::size_t first) const { return {read_quaternion(reader_, consecutive<4>(first)), vector3(first + 4)}; }

  void record() {
    const std::string_view kind = reader_.columns()[0];
    if (kind == "OBS") {
      observation();
    } else if (kind == "STATE") {
      state();
    } else if (kind == "LM") {
      reader_.expect_columns(5, "LM j x y z");
      landmarks_.push_back({index(1), reader_.line(), vector3(2)});
    } else if (kind == "LMPRIOR") {
      landmark_prior();
    } else if (kind == "PRIORPOSE") {
      pose_prior();
    } else if (kind == "PRIORVEL") {
      velocity_prior();
    } else if (kind == "CAM") {
      camera();
    } else if (kind == "QC") {
      qc();
    } else {
      reader_.fail(
          fmt::format("unknown record \"{}\"; expected CAM, QC, STATE, LM, OBS, PRIORPOSE, PRIORVEL or LMPRIOR", kind));
    }
  }

  void camera() {
    reader_.expect_columns(5, "CAM fx fy cx cy");
    if (has_camera_) reader_.fail("a second CAM record; expected one");
    has_camera_ = true;
    problem_.camera = {positive(1, "fx"), positive(2, "fy"), reader_.number(3, "cx"), reader_.number(4, "cy")};
  }

  void qc() {
    reader_.expect_columns(7, "QC q1 q2 q3 q4 q5 q6");
    if (has_qc_) reader_.fail("a second QC record; expected one");
    has_qc_ = true;
    problem_.qc = positive6(1, "the power spectral density");
  }

  void state() {
    reader_.expect_columns(16, "STATE i t qx qy qz qw px py pz wx wy wz vx vy vz");
    const double t = reader_.number(2, "the time");
    states_.push_back({index(1), reader_.line(), {t, pose(3), vector6(10, "the velocity")}});
  }

  void observation() {
    const bool has_covariance = reader_.columns().size() == 8;
    if (!has_covariance) reader_.expect_columns(6, "OBS t j u v sigma");
    landmark_references_.push_back(reference(2));
    problem_.observations.push_back({reader_.number(1, "the time"),
                                     landmark_references_.back().index,
                                     {reader_.number(3, "u"), reader_.number(4, "v")},
                                     has_covariance ? covariance(5) : positive(5, "sigma")});
  }

  PixelNoise covariance(std::size_t first) const {
    const PixelNoise noise(reader_.number(first, "xx"), reader_.number(first + 1, "xy"),
                           reader_.number(first + 2, "yy"));
    if (!noise.is_valid()) reader_.fail("the covariance xx xy yy is not positive definite");
    return noise;
  }

  void pose_prior() {
    reader_.expect_columns(15, "PRIORPOSE i qx qy qz qw px py pz s1 s2 s3 s4 s5 s6");
    state_references_.push_back(reference(1));
    problem_.pose_priors.push_back({state_references_.back().index, pose(2), positive6(9, "sigma")});
  }

  void velocity_prior() {
    reader_.expect_columns(14, "PRIORVEL i wx wy wz vx vy vz s1 s2 s3 s4 s5 s6");
    state_references_.push_back(reference(1));
    problem_.velocity_priors.push_back(
        {state_references_.back().index, vector6(2, "the velocity"), positive6(8, "sigma")});
  }

  void landmark_prior() {
    reader_.expect_columns(6, "LMPRIOR j x y z sigma");
    landmark_references_.push_back(reference(1));
    problem_.landmark_priors.push_back({landmark_references_.back().index, vector3(2), positive(5, "sigma")});
  }

  /// The values by index; every index from 0 on must occur once. Sorts the records by index.
  template <class Value>
  std::vector<Value> in_sequence(std::vector<Indexed<Value>>& records, const char* kind) const {
    std::ranges::stable_sort(records, {}, &Indexed<Value>::index);
    std::vector<Value> values;
    values.reserve(records.size());
    for (const Indexed<Value>& record : records) {
      const int expected = static_cast<int>(values.size());
      if (record.index < expected) fail(record.line, fmt::format("a second {} {}; expected one", kind, record.index));
      if (record.index > expected) {
        fail(record.line, fmt::format("{0} {1}, but there is no {0} {2}; expected indices 0, 1, 2, ... without gaps",
                                      kind, record.index, expected));
      }
      values.push_back(record.value);
    }
    return values;
  }

  void check_times() const {
    for (std::size_t i = 1; i < states_.size(); ++i) {
      if (!(states_[i - 1].value.t < states_[i].value.t)) {
        fail(states_[i].line, fmt::format("STATE {} has time {:.9f} s, not after the one before it ({:.9f} s); "
                                          "expected strictly increasing times",
                                          i, states_[i].value.t, states_[i - 1].value.t));
      }
    }
  }

  void check_references(const std::vector<Reference>& references, std::size_t count, const char* what) const {
    for (const Reference& reference : references) {
      if (static_cast<std::size_t>(reference.index) >= count) {
        fail(reference.line,
             fmt::format("{0} {1} does not exist; the file has {2} {0}s", what, reference.index, count));
      }
    }
  }
};

/// " a b c": the values, each preceded by a blank.
template <class Derived>
std::string columns(const Eigen::MatrixBase<Derived>& values) {
  std::string text;
  for (Eigen::Index i = 0; i < values.size(); ++i) fmt::format_to(std::back_inserter(text), " {}", values[i]);
  return text;
}

std::string columns(const SE3& T) { return columns(T.q.coeffs()) + columns(T.p); }

}  // namespace

Problem read_problem(const std::string& path) { return ProblemReader(path).read(); }

std::string format_problem(const Problem& problem) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  const PinholeCamera& camera = problem.camera;
  fmt::format_to(out, "CAM {} {} {} {}\nQC{}\n", camera.fx, camera.fy, camera.cx, camera.cy, columns(problem.qc));
  for (std::size_t i = 0; i < problem.states.size(); ++i) {
    const ControlState& state = problem.states[i];
    fmt::format_to(out, "STATE {} {}{}{}\n", i, state.t, columns(state.T), columns(state.velocity));
  }
  for (std::size_t j = 0; j < problem.landmarks.size(); ++j) {
    fmt::format_to(out, "LM {}{}\n", j, columns(problem.landmarks[j]));
  }
  for (const Problem::Observation& o : problem.observations) {
    fmt::format_to(out, "OBS {} {} {} {}", o.t, o.landmark, o.pixel.x(), o.pixel.y());
    if (o.noise.is_isotropic()) {
      fmt::format_to(out, " {}\n", o.noise.sigma());
    } else {
      fmt::format_to(out, " {} {} {}\n", o.noise.xx(), o.noise.xy(), o.noise.yy());
    }
  }
  for (const Problem::PosePrior& prior : problem.pose_priors) {
    fmt::format_to(out, "PRIORPOSE {}{}{}\n", prior.state, columns(prior.T), columns(prior.sigma));
  }
  for (const Problem::VelocityPrior& prior : problem.velocity_priors) {
    fmt::format_to(out, "PRIORVEL {}{}{}\n", prior.state, columns(prior.velocity), columns(prior.sigma));
  }
  for (const Problem::LandmarkPrior& prior : problem.landmark_priors) {
    fmt::format_to(out, "LMPRIOR {}{} {}\n", prior.landmark, columns(prior.position), prior.sigma);
  }
  return fmt::to_string(text);
}

Problem prepare(Problem problem) {
  const auto covered = [&](const Problem::Observation& o) {
    return !problem.states.empty() && o.t >= problem.states.front().t && o.t <= problem.states.back().t;
  };
  std::erase_if(problem.observations, [&](const Problem::Observation& o) { return !covered(o); });
  std::vector<int> counts(problem.landmarks.size(), 0);
  for (const Problem::Observation& o : problem.observations) ++counts[index(o.landmark)];
  const auto unusable = [&](const auto& item) { return counts[index(item.landmark)] < 2; };
  std::erase_if(problem.observations, unusable);
  std::erase_if(problem.landmark_priors, unusable);
  std::ranges::stable_sort(problem.observations, {},
                           [](const Problem::Observation& o) { return std::tuple(o.t, o.landmark); });
  return problem;
}

}  // namespace evbench
