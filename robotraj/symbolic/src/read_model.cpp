// The only file on the double-precision side, which libpinocchio already holds compiled.
#include "tree.hpp"

#include <pinocchio/serialization.hpp>

namespace robotraj {

Tree read_model(const std::string& text) {
  pinocchio::Model numeric;
  pinocchio::serialization::loadFromString(numeric, text);
  const auto model = std::make_shared<const Model>(numeric.cast<SX>());
  Tree tree{model->nq, model->nv, {}, {}, model->armature, model->gravity, model};
  for (std::size_t i = 0; i < static_cast<std::size_t>(model->njoints); ++i)
    tree.joints.push_back(
        {model->parents[i], model->idx_vs[i], model->nvs[i], model->jointPlacements[i], model->inertias[i]});
  for (const auto& frame : model->frames) tree.frames.push_back({frame.parentJoint, frame.placement});
  return tree;
}

}  // namespace robotraj
