#pragma once

#include "graph.hpp"

namespace robotraj {

/// The input `fext` (6 x njoints, linear first) as the forces Pinocchio takes, one per joint frame.
inline std::vector<Force> external_forces(Graph& graph, const Model& model) {
  const Matrix wrenches = graph.input("fext", 6, model.njoints);
  std::vector<Force> forces;
  for (Eigen::Index joint = 0; joint < model.njoints; ++joint) {
    const Eigen::Matrix<SX, 6, 1> wrench = wrenches.col(joint);
    forces.emplace_back(wrench);
  }
  return forces;
}

}  // namespace robotraj
