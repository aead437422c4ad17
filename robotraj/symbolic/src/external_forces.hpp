#pragma once

#include "graph.hpp"

namespace robotraj {

/// The input `fext` (6 x njoints, linear first) as forces on the bodies, in their joints' axes.
inline std::vector<Force> external_forces(Graph& graph, const Tree& tree) {
  const Matrix wrenches = graph.input("fext", 6, static_cast<Eigen::Index>(tree.joints.size()));
  std::vector<Force> forces;
  for (Eigen::Index joint = 0; joint < wrenches.cols(); ++joint) {
    const Eigen::Matrix<SX, 6, 1> wrench = wrenches.col(joint);
    forces.emplace_back(wrench);
  }
  return forces;
}

}  // namespace robotraj
