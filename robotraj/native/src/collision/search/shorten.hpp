// Shorter paths: straight motions instead of detours, of all joints and of single ones.
#pragma once

#include "rrt_connect.hpp"

namespace robotraj::native::collision {

/// Replaces random parts of a path, where that is free and shorter; `rounds` are tried.
///
/// Even rounds put a straight motion between two places, odd ones straighten one joint and keep the others.
/// Source: Geraerts and Overmars, Creating High-quality Paths for Motion Planning, IJRR 26 (2007).
Path shortened(StraightMotions& motions, Path path, const std::vector<double>& speeds, std::uint64_t seed,
               std::size_t rounds);

}  // namespace robotraj::native::collision
