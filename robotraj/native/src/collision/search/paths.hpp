// Paths between two configurations: trees of straight motions grow from both until they meet, and straight motions then
// replace detours, of all joints and of single ones.
//
// Source: Kuffner and LaValle, RRT-Connect: An Efficient Approach to Single-Query Path Planning, ICRA 2000.
#pragma once

#include "collision/polynomial_motion.hpp"

#include <cstdint>
#include <vector>

namespace robotraj::native::collision {

/// Configurations one after the other.
using Path = std::vector<std::vector<double>>;

/// Tells whether straight motions are free.
struct StraightMotions {
  PolynomialMotion motion;
  double resolution;  ///< [m], see `PolynomialMotion::free`

  bool free(const std::vector<double>& a, const std::vector<double>& b) {
    return motion.free(a.data(), b.data(), resolution);
  }
};

struct Search {
  std::vector<double> lower, upper;  ///< where configurations are drawn
  std::vector<double> speeds;        ///< joints are weighted by the time that they need
  double range;                      ///< longest motion of one extension [s]
  std::uint64_t seed;
  std::size_t iterations;  ///< configurations drawn at most
  double seconds;          ///< time at most
};

/// Empty where no path was found.
Path rrt_connect(StraightMotions& motions, const Search& search, const std::vector<double>& start,
                 const std::vector<double>& goal);

/// Replaces random parts of a path, where that is free and shorter; `rounds` are tried.
///
/// Even rounds put a straight motion between two places, odd ones straighten one joint and keep the others.
/// Source: Geraerts and Overmars, Creating High-quality Paths for Motion Planning, IJRR 26 (2007).
Path shortened(StraightMotions& motions, Path path, const std::vector<double>& speeds, std::uint64_t seed,
               std::size_t rounds);

}  // namespace robotraj::native::collision
