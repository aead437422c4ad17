// The Python interface: a tree of joints is built from numbers, and functions are returned as casadi's serialised bytes.
#include "algorithms.hpp"
#include "graph.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <casadi/config.h>
#include <pinocchio/config.hpp>

namespace nb = nanobind;
using robotraj::JointKind;
using robotraj::Reference;
using robotraj::SymbolicModel;
using robotraj::Tree;

namespace {

template <Eigen::Index size>  // -1 for any
using Numbers = nb::ndarray<const double, nb::shape<size>, nb::c_contig, nb::device::cpu>;

template <Eigen::Index size>
Eigen::Matrix<double, size, 1> to_eigen(const Numbers<size>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, size, 1>>(numbers.data());
}

/// A 3 x 4 matrix (R, p), row after row.
robotraj::Placement to_placement(const Numbers<12>& numbers) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> placement(numbers.data());
  return {placement.leftCols<3>().cast<robotraj::SX>(), placement.col(3).cast<robotraj::SX>()};
}

/// Mass, centre of mass and the inertia about it: xx, xy, yy, xz, yz, zz.
robotraj::Inertia to_inertia(const Numbers<10>& numbers) {
  const auto body = to_eigen<10>(numbers).cast<robotraj::SX>().eval();
  return {body[0], body.segment<3>(1), robotraj::Inertia::Symmetric3(body.tail<6>().eval())};
}

/// The universe alone.
void make_tree(Tree* self, const Numbers<3>& gravity, const Numbers<Eigen::Dynamic>& armature) {
  const robotraj::Inertia none = robotraj::Inertia::Zero();
  const Eigen::Map<const Eigen::VectorXd> inertia(armature.data(), static_cast<Eigen::Index>(armature.size()));
  const robotraj::Motion downwards(to_eigen<3>(gravity).cast<robotraj::SX>(), robotraj::Vector3::Zero());
  new (self)
      Tree{0, 0, {{0, 0, 0, robotraj::Placement::Identity(), none, {}}}, {}, inertia.cast<robotraj::SX>(), downwards};
}

void add_joint(Tree& tree, std::size_t parent, const Numbers<12>& placement, const Numbers<10>& body) {
  if (parent >= tree.joints.size()) throw std::invalid_argument("a joint comes before its parent");
  tree.joints.push_back({parent, tree.nv, 0, to_placement(placement), to_inertia(body), {}});
}

/// Appends one more part to the chain of the last joint.
void add_part(Tree& tree, JointKind kind, const Numbers<12>& placement, const Numbers<6>& axis) {
  const robotraj::JointPart part{kind, tree.nq, tree.nv, to_placement(placement), to_eigen<6>(axis)};
  tree.joints.back().parts.push_back(part);
  tree.joints.back().count += part.rates();
  tree.nq += part.positions();
  tree.nv += part.rates();
}

void make_model(SymbolicModel* self, const Tree& tree, bool parametric) {
  if (tree.armature.size() != tree.nv) throw std::invalid_argument("armature is given for another number of rates");
  new (self) SymbolicModel(tree, parametric);
}

nb::bytes to_bytes(const std::string& text) { return nb::bytes(text.data(), text.size()); }

template <std::string (*algorithm)(const SymbolicModel&)>
nb::bytes of_model(const SymbolicModel& symbolic) {
  return to_bytes(algorithm(symbolic));
}

template <std::string (*algorithm)(const SymbolicModel&, std::size_t, Reference)>
nb::bytes of_frame(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  return to_bytes(algorithm(symbolic, frame, reference));
}

}  // namespace

NB_MODULE(_graphs, m) {
  // What a script holds when the interpreter ends is no leak.
  nanobind::set_leak_warnings(false);
  m.attr("PINOCCHIO_VERSION") = PINOCCHIO_VERSION;
  m.attr("CASADI_VERSION") = CASADI_VERSION_STRING;

  nb::enum_<JointKind>(m, "JointKind")
      .value("SCREW", JointKind::screw)
      .value("CIRCLE", JointKind::circle)
      .value("PLANAR", JointKind::planar)
      .value("SPHERICAL", JointKind::spherical)
      .value("FREE_FLYER", JointKind::free_flyer);

  nb::class_<Tree>(m, "Tree")
      .def("__init__", &make_tree, nb::arg("gravity"), nb::arg("armature"))
      .def("add_joint", &add_joint, nb::arg("parent"), nb::arg("placement"), nb::arg("body"))
      .def("add_part", &add_part, nb::arg("kind"), nb::arg("placement"), nb::arg("axis"))
      .def(
          "add_frame",
          [](Tree& tree, std::size_t joint, const Numbers<12>& placement) {
            tree.frames.push_back({joint, to_placement(placement)});
          },
          nb::arg("joint"), nb::arg("placement"));

  nb::class_<SymbolicModel>(m, "Graphs")
      .def("__init__", &make_model, nb::arg("tree"), nb::arg("parametric"))
      .def("forward_dynamics", of_model<robotraj::forward_dynamics>)
      .def("inverse_dynamics", of_model<robotraj::inverse_dynamics>)
      .def("nonlinear_effects", of_model<robotraj::nonlinear_effects>)
      .def("gravity", of_model<robotraj::gravity>)
      .def("mass_matrix", of_model<robotraj::mass_matrix>)
      .def("kinetic_energy", of_model<robotraj::kinetic_energy>)
      .def("potential_energy", of_model<robotraj::potential_energy>)
      .def("center_of_mass", of_model<robotraj::center_of_mass>)
      .def("centroidal_momentum", of_model<robotraj::centroidal_momentum>)
      .def("integrate", of_model<robotraj::integrate>)
      .def("difference", of_model<robotraj::difference>)
      .def("configuration_rate", of_model<robotraj::configuration_rate>)
      .def("frame_placement", [](const SymbolicModel& symbolic,
                                 std::size_t frame) { return to_bytes(robotraj::frame_placement(symbolic, frame)); })
      .def("frame_velocity", of_frame<robotraj::frame_velocity>)
      .def("frame_acceleration", of_frame<robotraj::frame_acceleration>)
      .def("frame_jacobian", of_frame<robotraj::frame_jacobian>);
}
