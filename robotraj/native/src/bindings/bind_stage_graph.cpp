// Stage functions and their derivatives, from Python.
#include "tape/stage_graph.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "patterns.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

namespace nb = nanobind;

namespace robotraj::native {

void bind_stage_graph(nb::module_& m) {
  nb::class_<StageGraph>(m, "StageGraph")
      .def(nb::init<const std::string&>(), nb::arg("text"))
      .def_prop_ro("inputs", &StageGraph::inputs)
      .def_prop_ro("constants", &StageGraph::constants)
      .def_prop_ro("torques", &StageGraph::torques)
      .def_prop_ro("outputs", &StageGraph::outputs)
      .def_prop_ro("arguments", &StageGraph::arguments)
      .def("values", &StageGraph::values)
      .def("slopes", &StageGraph::slopes)
      .def("gradient", &StageGraph::gradient)
      .def("curvature", &StageGraph::curvature)
      .def("chain", &StageGraph::chain)
      .def("places",
           [](const StageGraph& graph) {
             std::optional<std::vector<std::int64_t>> found = graph.places();
             return found ? std::optional(to_numpy(std::move(*found))) : std::nullopt;
           })
      .def(
          "selected", [](const StageGraph& graph, const Indices& outputs) { return graph.selected(copied(outputs)); },
          nb::arg("outputs"))
      .def("split",
           [](const StageGraph& graph) {
             auto [curved, linear, pattern] = graph.split();
             return std::tuple(to_numpy(std::move(curved)), std::move(linear), std::move(pattern));
           })
      .def("constant_slopes", [](const StageGraph& graph) { return to_numpy(graph.constant_slopes()); });
}

}  // namespace robotraj::native
