// Tapes, trees and the blocks made of them, from Python.
#include "point_functions/tape_block.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "patterns.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

/// `numbers` has a row of 28 for every joint: direction, rotation, translation, mass, centre, inertia.
RigidTree tree_of(const Indices& parents, const Indices& turns, const Doubles& numbers, const Doubles& armature,
                  const Doubles& gravity, bool flies) {
  constexpr std::size_t width = 28;
  const std::size_t count = parents.size();
  checked(turns, count, "turns");
  checked(armature, count, "armature");
  const double* row = checked(numbers, width * count, "numbers");
  std::vector<Link> links;
  for (std::size_t i = 0; i < count; ++i, row += width) {
    const std::int64_t parent = parents.data()[i];
    if (parent < -1 || parent >= static_cast<std::int64_t>(i))
      throw std::invalid_argument("a joint comes before its parent");
    links.push_back({static_cast<std::int32_t>(parent), turns.data()[i] != 0, row, row + 3, row + 12, row[15], row + 16,
                     row + 19, armature.data()[i]});
  }
  return RigidTree(links, checked(gravity, 3, "gravity"), flies);
}

Recipe recipe_of(const Tape& tape, bool jacobian, bool hessian, std::size_t made, std::size_t result,
                 std::size_t results, const Indices& out, const Indices& left, const Indices& right,
                 const std::vector<Call>& calls) {
  Recipe recipe{tape, jacobian, hessian, made, result, results, {}, calls};
  checked(left, out.size(), "left");
  checked(right, out.size(), "right");
  for (std::size_t i = 0; i < out.size(); ++i)
    recipe.products.push_back({narrow(out.data()[i]), narrow(left.data()[i]), narrow(right.data()[i])});
  return recipe;
}

std::shared_ptr<TapeBlock> block_of(std::size_t count, std::size_t inputs, std::size_t constants, const Recipe& values,
                                    const Recipe* jacobian, const Recipe* hessian, const Recipe* convex,
                                    const Recipe* cost, const Recipe* gradient, std::ptrdiff_t costed,
                                    const Torques* torques, const std::string& processor) {
  const auto or_none = [](const Recipe* recipe) { return recipe ? *recipe : Recipe{}; };
  Recipes recipes{values, or_none(jacobian), or_none(cost), or_none(gradient), or_none(hessian), or_none(convex)};
  const PointSizes sizes{
      count, inputs, constants, values.results, recipes[1].results, recipes[4].results, cost ? costed : -1};
  return std::make_shared<TapeBlock>(sizes, std::move(recipes),
                                     torques ? std::optional<Torques>(*torques) : std::nullopt, kernels_of(processor));
}

}  // namespace

void bind_tape_block(nb::module_& m) {
  m.def("processors", [] {
    std::vector<std::string> names;
    for (const Kernels* each : kernels()) names.emplace_back(each->processor);
    return names;
  });

  nb::exception<NotATape>(m, "NotATape", PyExc_ValueError);

  nb::class_<RigidTree>(m, "RigidTree")
      .def(nb::new_(&tree_of), nb::arg("parents"), nb::arg("turns"), nb::arg("numbers"), nb::arg("armature"),
           nb::arg("gravity"), nb::arg("flies"))
      .def_prop_ro("positions", [](const RigidTree& robot) { return robot.tree().positions(); })
      .def_prop_ro("rates", [](const RigidTree& robot) { return robot.tree().rates(); })
      .def("jacobian_pattern", [](const RigidTree& robot) { return jacobian_pattern(robot.tree()); })
      .def("hessian_pattern", [](const RigidTree& robot) { return hessian_pattern(robot.tree()); });

  nb::class_<Tape>(m, "Tape").def_prop_ro("outputs", &Tape::outputs);

  nb::class_<Torques>(m, "Torques")
      .def(nb::new_(
               [](const RigidTree& robot, const Indices& places) { return Torques{robot, narrow(places), {}, {}}; }),
           nb::arg("robot"), nb::arg("places"))
      .def(nb::new_([](const RigidTree& robot, const Tape& arguments, const Tape& curvature) {
             return Torques{robot, {}, arguments, curvature};
           }),
           nb::arg("robot"), nb::arg("arguments"), nb::arg("curvature"));

  nb::class_<Call>(m, "Call").def(
      nb::new_([](std::shared_ptr<Tape> tape, const Indices& inputs, const Indices& multipliers) {
        return Call{std::move(tape), narrow(inputs), narrow(multipliers)};
      }),
      nb::arg("tape"), nb::arg("inputs"), nb::arg("multipliers"));

  nb::class_<Recipe>(m, "Recipe")
      .def(nb::new_(&recipe_of), nb::arg("tape"), nb::arg("jacobian"), nb::arg("hessian"), nb::arg("made"),
           nb::arg("result"), nb::arg("results"), nb::arg("out"), nb::arg("left"), nb::arg("right"),
           nb::arg("calls") = nb::list());

  nb::class_<TapeBlock, PointBlock>(m, "TapeBlock")
      .def(nb::new_(&block_of), nb::arg("count"), nb::arg("inputs"), nb::arg("constants"), nb::arg("values"),
           nb::arg("jacobian") = nb::none(), nb::arg("hessian") = nb::none(), nb::arg("convex") = nb::none(),
           nb::arg("cost") = nb::none(), nb::arg("gradient") = nb::none(), nb::arg("costed") = -1,
           nb::arg("torques") = nb::none(), nb::arg("processor") = "");
}

}  // namespace robotraj::native
