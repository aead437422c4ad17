// Proof of distances along a motion of polynomials, or where and by how much they are short.
//
// Distances change on a piece of an interval as in `straight_motion.hpp`. Their rates and accelerations are bounded by
// the Bernstein coefficients of their polynomials on the whole interval. A piece is halved for the pairs that are not
// proved.
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

class PolynomialMotion {
 public:
  PolynomialMotion(const SphereTree& tree, double margin);
  /// Bernstein coefficients of an interval: `count` configurations, one after the other.
  void prove(int interval, const double* coefficients, int count);

  std::vector<Short> shorts;  ///< each interval and pair once
  Short least;                ///< least distance that was seen

 private:
  /// Pair of groups whose spheres are checked, -1 against a shape.
  struct Candidate {
    int pair, first, second;
    int found;  ///< its place in `shorts`, -1 for none
  };
  struct Look {
    double distance, change;
  };

  void read(double tau);
  void piece(double tau, double h, int depth, std::vector<Candidate> candidates);
  std::vector<Candidate> near() const;
  Look look(const Candidate& candidate, double h) const;
  void note(Candidate& candidate, double tau, double distance);

  const SphereTree& tree_;
  double margin_;
  MovingSpheres spheres_;
  Rates rates_;
  std::vector<double> q_, rate_, work_;
  std::vector<int> joint_of_;
  const double* coefficients_ = nullptr;
  int count_ = 0, interval_ = 0;
};

}  // namespace robotraj::native::collision
