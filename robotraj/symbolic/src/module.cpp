// The Python face: a model goes in as text, functions come out as casadi's serialised bytes.
#include "algorithms.hpp"
#include "graph.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <casadi/config.h>
#include <pinocchio/config.hpp>

namespace nb = nanobind;
using robotraj::Reference;
using robotraj::SymbolicModel;

namespace {

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

  nb::class_<SymbolicModel>(m, "Graphs")
      .def(nb::init<const std::string&, bool>(), nb::arg("text"), nb::arg("parametric"))
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
