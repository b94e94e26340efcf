#include "core/smoother/smoother.hpp"

#include <utility>

#include "core/smoother/engine/engine.hpp"

namespace evbench::smoother {

namespace {

FactorGraph empty_graph(const PinholeCamera& camera, const Vector6& qc, const RobustLoss& loss,
                        const MotionPrior& motion_prior) {
  FactorGraph graph;
  graph.camera = camera;
  graph.motion_prior = motion_prior;
  graph.qc = qc;
  graph.loss = loss;
  return graph;
}

}  // namespace

Smoother::Smoother(const PinholeCamera& camera, const Vector6& qc, const RobustLoss& loss,
                   const SmootherOptions& options, const MotionPrior& motion_prior)
    : Smoother(empty_graph(camera, qc, loss, motion_prior), options) {}
Smoother::Smoother(FactorGraph graph, const SmootherOptions& options)
    : engine_(std::make_unique<Engine>(std::move(graph), options)) {}
Smoother::Smoother(const Smoother& other) : engine_(std::make_unique<Engine>(*other.engine_)) {}
Smoother::Smoother(Smoother&&) noexcept = default;
Smoother& Smoother::operator=(const Smoother& other) {
  engine_ = std::make_unique<Engine>(*other.engine_);
  return *this;
}
Smoother& Smoother::operator=(Smoother&&) noexcept = default;
Smoother::~Smoother() = default;

const FactorGraph& Smoother::graph() const { return engine_->graph(); }
int Smoother::first_state() const { return engine_->first_state(); }
bool Smoother::is_marginalised(int landmark) const { return engine_->is_marginalised(landmark); }
double Smoother::reprojection_mean(int landmark) { return engine_->reprojection_mean(landmark); }
void Smoother::add_state(const ControlState& guess) { engine_->add_state(guess); }
void Smoother::add_state_at(double t) { engine_->add_state_at(t); }
void Smoother::add_pose_prior(const PosePrior& prior) { engine_->add_pose_prior(prior); }
void Smoother::add_velocity_prior(const VelocityPrior& prior) { engine_->add_velocity_prior(prior); }
void Smoother::anchor_scale(const Vector3& origin, std::vector<int> landmarks) {
  engine_->anchor_scale(origin, std::move(landmarks));
}
int Smoother::add_landmark(const Vector3& guess, const LandmarkPrior& prior) {
  return engine_->add_landmark(guess, prior);
}
void Smoother::remove_prior(int landmark) { engine_->remove_prior(landmark); }
bool Smoother::add_observation(int landmark, const Observation& observation) {
  return engine_->add_observation(landmark, observation);
}
bool Smoother::open_newest_interval() { return engine_->open_newest_interval(); }
bool Smoother::add_observation_and_update(int landmark, const Observation& observation) {
  return engine_->add_observation_and_update(landmark, observation);
}
void Smoother::remove_newest_state() { engine_->remove_newest_state(); }
void Smoother::set_qc(int k, const Vector6& qc, double expansion) { engine_->set_qc(k, qc, expansion); }
void Smoother::set_next_qc(const Vector6& qc) { engine_->set_next_qc(qc); }
void Smoother::set_loss(const RobustLoss& loss) { engine_->set_loss(loss); }
void Smoother::remove_landmark(int landmark) { engine_->remove_landmark(landmark); }
void Smoother::remove_observations(int landmark, double from) { engine_->remove_observations(landmark, from); }
void Smoother::scale_sigmas(int landmark, double scale) { engine_->scale_sigmas(landmark, scale); }
bool Smoother::set_state(int i, const ControlState& estimate) { return engine_->set_state(i, estimate); }
bool Smoother::set_landmark(int landmark, const Vector3& position) { return engine_->set_landmark(landmark, position); }
UpdateSummary Smoother::update() { return engine_->update(); }
UpdateSummary Smoother::update_everything() { return engine_->update_everything(); }
OptimiseSummary Smoother::optimise(int max_iterations, double relative_tolerance) {
  return engine_->optimise(max_iterations, relative_tolerance);
}
std::optional<PairMatrix> Smoother::neighbours(int k) { return engine_->neighbours(k); }
std::vector<PairMatrix> Smoother::chain_covariances(int first) { return engine_->chain_covariances(first); }
std::optional<Matrix12> Smoother::poses(int i, int j) { return engine_->poses(i, j); }
std::optional<Matrix12> Smoother::covariance(double t) { return engine_->covariance(t); }
std::optional<Matrix12> Smoother::newest_covariance() { return engine_->newest_covariance(); }
std::optional<Matrix3> Smoother::landmark_covariance(int landmark) { return engine_->landmark_covariance(landmark); }
std::optional<Matrix2> Smoother::predicted_covariance(int landmark, const ImageJacobian& J_state,
                                                      const Matrix23& J_landmark) {
  return engine_->predicted_covariance(landmark, J_state, J_landmark);
}

}  // namespace evbench::smoother
