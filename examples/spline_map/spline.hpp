#pragma once

#include <cstddef>
#include <evbench/plugin.hpp>
#include <vector>

#include "spline_segment.hpp"

namespace spline_map {

/// A cubic B-spline with knots evenly spaced in time. Segment s is between start + s·spacing and
/// start + (s + 1)·spacing, and depends on the knots s to s + 3.
class Spline {
 public:
  Spline() = default;
  /// A spline of one segment, at rest at T.
  Spline(double start, double spacing, const SE3& T) : start_(start), spacing_(spacing), knots_(4, Knot(T)) {}

  double start() const { return start_; }      ///< [s]
  double spacing() const { return spacing_; }  ///< [s]
  double end() const { return start_ + static_cast<double>(segments()) * spacing_; }
  std::size_t segments() const { return knots_.size() - 3; }

  std::vector<Knot>& knots() { return knots_; }
  const std::vector<Knot>& knots() const { return knots_; }
  /// The time at which knot k has its largest weight.
  double knot_time(std::size_t k) const { return start_ + (static_cast<double>(k) - 1.0) * spacing_; }

  /// Adds knots that repeat the last step (constant velocity) until the spline covers t.
  void extend_to(double t);
  /// Removes segments that begin at or after t, except the first.
  void cut(double t);

  /// The segment that contains t (the nearest one for times outside) and the position u in it: in [0, 1] for t within.
  struct Place {
    std::size_t segment = 0;
    double u = 0.0;
  };
  Place place(double t) const;
  SplineSegment segment(std::size_t s) const { return {knots_[s], knots_[s + 1], knots_[s + 2], knots_[s + 3]}; }

  SE3 pose(double t) const;
  evbench::ControlState state(double t) const;

 private:
  double start_ = 0.0, spacing_ = 1.0;
  std::vector<Knot> knots_ = std::vector<Knot>(4);
};

}  // namespace spline_map
