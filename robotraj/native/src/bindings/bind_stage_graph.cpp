// Stage functions and their derivatives, from Python.
#include "tape/stage_graph.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "patterns.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

auto slopes_of(const StageGraph& graph, std::optional<std::size_t> output) {
  StageGraph::Slopes found = output ? graph.slopes(*output) : graph.slopes();
  return std::tuple(std::move(found.tape), to_arrays(found.by_v), to_arrays(found.by_r));
}

auto curvature_of(const StageGraph& graph) {
  StageGraph::Curvature found = graph.curvature();
  return std::tuple(std::move(found.tape), std::move(found.convex), to_arrays(found.vv), to_arrays(found.rv),
                    to_arrays(found.rr));
}

auto chain_of(const StageGraph& graph) {
  StageGraph::Arguments found = graph.chain();
  return std::tuple(std::move(found.tape), std::move(found.curved), to_arrays(found.by_v), to_arrays(found.curvature));
}

std::optional<IndexResult> places_of(const StageGraph& graph) {
  std::optional<std::vector<std::int64_t>> found = graph.places();
  return found ? std::optional(to_numpy(std::move(*found))) : std::nullopt;
}

auto split_of(const StageGraph& graph) {
  StageGraph::Split found = graph.split();
  return std::pair(to_numpy(std::move(found.curved)), std::move(found.linear));
}

}  // namespace

void bind_stage_graph(nb::module_& m) {
  nb::class_<LinearPart>(m, "LinearPart")
      .def("pattern", [](const LinearPart& part) { return to_arrays(part.pattern()); })
      .def(
          "at",
          [](const LinearPart& part, const Doubles& constants, std::size_t count) {
            return to_numpy(part.at(checked(constants, part.constants() * count, "constants"), count));
          },
          nb::arg("constants"), nb::arg("count"));

  nb::class_<StageGraph>(m, "StageGraph")
      .def(nb::init<const std::string&>(), nb::arg("text"))
      .def_prop_ro("inputs", &StageGraph::inputs)
      .def_prop_ro("constants", &StageGraph::constants)
      .def_prop_ro("torques", &StageGraph::torques)
      .def_prop_ro("outputs", &StageGraph::outputs)
      .def_prop_ro("arguments", &StageGraph::arguments)
      .def("values", &StageGraph::values)
      .def("output", &StageGraph::output, nb::arg("which"))
      .def("slopes", &slopes_of, nb::arg("output") = nb::none())
      .def("gradient", &StageGraph::gradient, nb::arg("which"))
      .def("curvature", &curvature_of)
      .def("places", &places_of)
      .def("chain", &chain_of)
      .def(
          "selected", [](const StageGraph& graph, const Indices& outputs) { return graph.selected(copied(outputs)); },
          nb::arg("outputs"))
      .def("split", &split_of)
      .def("constant_slopes", [](const StageGraph& graph) { return to_numpy(graph.constant_slopes()); });
}

}  // namespace robotraj::native
