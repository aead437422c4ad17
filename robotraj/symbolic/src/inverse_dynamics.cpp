#include "algorithms.hpp"
#include "external_forces.hpp"

#include <pinocchio/algorithm/rnea.hpp>

namespace robotraj {

std::string inverse_dynamics(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  const Vector a = graph.input("a", model.nv);
  const std::vector<Force> fext = external_forces(graph, model);
  graph.output("tau", pinocchio::rnea(model, data, q, v, a, fext));
  return graph.serialize("inverse_dynamics");
}

std::string nonlinear_effects(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  graph.output("nle", pinocchio::nonLinearEffects(model, data, q, v));
  return graph.serialize("nonlinear_effects");
}

std::string gravity(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  graph.output("g", pinocchio::computeGeneralizedGravity(model, data, q));
  return graph.serialize("gravity");
}

}  // namespace robotraj
