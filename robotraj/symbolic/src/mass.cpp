// What follows from the distribution of mass: inertia matrix, energies, centre of mass, momentum.
#include "algorithms.hpp"
#include "graph.hpp"

#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>

namespace robotraj {

std::string mass_matrix(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  Matrix M = pinocchio::crba(model, data, q, pinocchio::Convention::LOCAL);
  M.triangularView<Eigen::StrictlyLower>() = M.transpose().triangularView<Eigen::StrictlyLower>();
  graph.output("M", M);
  return graph.serialize("mass_matrix");
}

std::string kinetic_energy(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  graph.output("energy", pinocchio::computeKineticEnergy(model, data, q, v));
  return graph.serialize("kinetic_energy");
}

std::string potential_energy(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  graph.output("energy", pinocchio::computePotentialEnergy(model, data, q));
  return graph.serialize("potential_energy");
}

std::string center_of_mass(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  const Vector a = graph.input("a", model.nv);
  pinocchio::centerOfMass(model, data, q, v, a, false);
  graph.output("position", data.com[0]);
  graph.output("velocity", data.vcom[0]);
  graph.output("acceleration", data.acom[0]);
  return graph.serialize("center_of_mass");
}

std::string centroidal_momentum(const SymbolicModel& symbolic) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  graph.output("h", pinocchio::computeCentroidalMomentum(model, data, q, v).toVector());
  return graph.serialize("centroidal_momentum");
}

}  // namespace robotraj
