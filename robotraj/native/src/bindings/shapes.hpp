// Joints, spheres and obstacles from plain arrays.
#pragma once

#include "arrays.hpp"
#include "collision/sphere_tree.hpp"

#include <Eigen/Geometry>

namespace robotraj::native {

using Row = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

constexpr std::size_t JOINT_NUMBERS = 15, SHAPE_NUMBERS = 16;

inline std::vector<collision::Joint> joints_of(const Indices& parents, const Indices& turns, const Doubles& numbers) {
  checked(turns, parents.size(), "turns");
  const double* at = checked(numbers, JOINT_NUMBERS * parents.size(), "the numbers of the joints");
  std::vector<collision::Joint> joints;
  for (std::size_t i = 0; i < parents.size(); ++i, at += JOINT_NUMBERS)
    joints.push_back({static_cast<int>(parents.data()[i]), turns.data()[i] != 0, Eigen::Map<const Eigen::Vector3d>(at),
                      Row(at + 3), Eigen::Map<const Eigen::Vector3d>(at + 12)});
  return joints;
}

inline std::vector<collision::Sphere> spheres_of(const Doubles& numbers) {
  std::vector<collision::Sphere> spheres;
  for (const double* at = numbers.data(); at != numbers.data() + numbers.size() / 4 * 4; at += 4)
    spheres.push_back({Eigen::Map<const Eigen::Vector3d>(at), at[3]});
  return spheres;
}

/// Vertices are in the frames of the shapes; triangles have three each, counter-clockwise from outside.
inline std::vector<collision::Shape> shapes_of(const Indices& kinds, const Doubles& numbers, const Indices& triangles,
                                               const Doubles& corners) {
  const double* at = checked(numbers, SHAPE_NUMBERS * kinds.size(), "the numbers of the obstacles");
  checked(triangles, kinds.size(), "triangles");
  std::vector<collision::Shape> shapes;
  const double *corner = corners.data(), *end = corner + corners.size();
  for (std::size_t i = 0; i < kinds.size(); ++i, at += SHAPE_NUMBERS) {
    const auto kind = static_cast<collision::Kind>(kinds.data()[i]);
    shapes.push_back(
        {kind, Row(at), Eigen::Map<const Eigen::Vector3d>(at + 9), Eigen::Map<const Eigen::Vector4d>(at + 12), {}});
    for (std::int64_t t = 0; t < triangles.data()[i]; ++t, corner += 9) {
      if (end - corner < 9) throw std::invalid_argument("an obstacle has fewer corners than its triangles need");
      collision::Triangle triangle;
      for (int k = 0; k < 3; ++k) triangle.corners[k] = Eigen::Map<const Eigen::Vector3d>(corner + 3 * k);
      const auto& c = triangle.corners;
      triangle.normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      shapes.back().triangles.push_back(triangle);
    }
  }
  return shapes;
}

}  // namespace robotraj::native
