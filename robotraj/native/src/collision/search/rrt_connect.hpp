// A path between two configurations: trees of straight motions grow from both until they meet.
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

}  // namespace robotraj::native::collision
