// Paths between two configurations: trees of straight motions grow from both until they meet, and straight motions then
// replace detours, of all joints and of single ones.
//
// Source: Kuffner and LaValle, RRT-Connect: An Efficient Approach to Single-Query Path Planning, ICRA 2000.
#pragma once

#include "collision/polynomial_motion.hpp"

#include <cstdint>
#include <vector>

namespace robotraj::native::collision {

using Point = std::vector<double>;
/// Configurations one after the other.
using Path = std::vector<Point>;

/// Tells whether straight motions are free.
struct StraightMotions {
  PolynomialMotion motion;
  double resolution;  ///< [m], see `PolynomialMotion::free`

  bool free(const Point& a, const Point& b) { return motion.free(a.data(), b.data(), resolution); }
};

/// The root of the sum of squares of the times [s] that the joints need.
double distance(const Point& a, const Point& b, const Point& speeds);

struct Search {
  Point lower, upper;  ///< where configurations are drawn
  Point speeds;        ///< joints are weighted by the time that they need
  double range;        ///< longest motion of one extension [s]
  std::uint64_t seed;
  std::size_t iterations;  ///< configurations drawn at most
  double seconds;          ///< time at most
};

/// Empty where no path was found.
Path rrt_connect(StraightMotions& motions, const Search& search, const Point& start, const Point& goal);

/// Replaces random parts of a path, where that is free and shorter; `rounds` are tried.
///
/// Even rounds put a straight motion between two places, odd ones straighten one joint and keep the others.
/// Source: Geraerts and Overmars, Creating High-quality Paths for Motion Planning, IJRR 26 (2007).
Path shortened(StraightMotions& motions, Path path, const Point& speeds, std::uint64_t seed, std::size_t rounds);

}  // namespace robotraj::native::collision
