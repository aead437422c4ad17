#include "algorithms.hpp"
#include "external_forces.hpp"

#include <pinocchio/algorithm/aba.hpp>

namespace robotraj {

std::string forward_dynamics(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  const Vector tau = graph.input("tau", model.nv);
  const std::vector<Force> fext = external_forces(graph, model);
  graph.output("a", pinocchio::aba(model, data, q, v, tau, fext, pinocchio::Convention::LOCAL));
  return graph.serialize("forward_dynamics");
}

}  // namespace robotraj
