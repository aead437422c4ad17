// Whether spheres stay free along a motion of polynomials, straight ones among them, or where and by how much they are
// short: proved by bounds on their motion, not sampled.
//
// The distance d of a sphere's centre from a convex shape, or from another centre, is a convex function of their
// relative place, so that along a motion q(s), with its gradient n at s_0,
//
//     d(s) >= d(s_0) - h abs(n' v) - h^2 A / 2,   h = abs(s - s_0),
//
// v the relative velocity at s_0, A the bound of `moving_spheres.hpp` on the relative acceleration, by the Bernstein
// coefficients of the polynomials on the whole interval. A piece is halved for the pairs that are not proved.
#pragma once

#include "moving_spheres.hpp"

#include <vector>

namespace robotraj::native::collision {

/// A pair of spheres, or of a sphere and a shape, on an interval, with its least distance that was seen or bounded.
struct Short {
  int interval, first, second;
  bool self;
  double tau, distance;
};

/// Examines motions of one robot; keeps its memory between them.
class PolynomialMotion {
 public:
  /// Spheres keep `margin` [m].
  PolynomialMotion(const SphereTree& tree, double margin);
  /// Bernstein coefficients of an interval: `count` configurations, one after the other.
  void prove(int interval, const double* coefficients, int count);
  /// Whether the straight motion from a to b is free; one that comes within `resolution` [m] of the margin is not.
  bool free(const double* a, const double* b, double resolution);

  std::vector<Short> shorts;  ///< each interval and pair once
  Short least;                ///< least distance that was seen

 private:
  /// Pair of groups whose spheres are checked, -1 against a shape.
  struct Candidate {
    int pair, first, second;
    int found;  ///< its place in `shorts`, -1 for none
  };
  /// A distance, and by how much it may change within h of the time.
  struct Look {
    double distance, change;
  };
  /// Half of an interval is h, its middle tau.
  struct Piece {
    double tau;
    std::vector<Candidate> candidates;
  };

  void begin(const double* coefficients, int count);
  void read(double tau);
  void piece(double tau, double h, int depth, std::vector<Candidate> candidates);
  std::vector<Candidate> near() const;
  Look against(int joint, const Sphere& sphere, const Vector3& centre, const Shape& shape, double h) const;
  Look between(std::size_t pair, const Sphere& a, const Vector3& p, const Sphere& b, const Vector3& q, double h) const;
  Look look(const Candidate& candidate, double h) const;
  bool proved(const Look& seen) const { return seen.distance - margin_ > seen.change; }
  void note(Candidate& candidate, double tau, double distance);

  const SphereTree& tree_;
  double margin_;
  MovingSpheres spheres_;
  Rates rates_;
  std::vector<double> q_, rate_, work_, ends_;
  std::vector<int> joint_of_;
  const double* coefficients_ = nullptr;
  int count_ = 0, interval_ = 0;
};

}  // namespace robotraj::native::collision
