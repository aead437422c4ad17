// Spheres on a tree of joints among obstacles: distances, straight motions and paths, from plain arrays.
#include "arrays.hpp"
#include "bindings.hpp"
#include "collision/polynomial_motion.hpp"
#include "collision/search/paths.hpp"
#include "shapes.hpp"

namespace nb = nanobind;

namespace robotraj::native {

namespace {

using collision::PolynomialMotion;
using collision::StraightMotions;
class SphereTree {
 public:
  SphereTree(const Indices& parents, const Indices& turns, const Doubles& joints, const Indices& groups,
             const Indices& group_of, const Doubles& spheres, const Indices& pairs, const Indices& kinds,
             const Doubles& shapes, const Indices& triangles, const Doubles& corners)
      : tree_(joints_of(parents, turns, joints), narrow(groups), narrow(group_of), spheres_of(spheres), pairs_of(pairs),
              shapes_of(kinds, shapes, triangles, corners)) {
    checked(group_of, spheres.size() / 4, "the groups of the spheres");
  }

  Result clearances(const Doubles& q) const {
    const std::size_t n = tree_.joints.size(), count = n ? q.size() / n : 0;
    checked(q, n * count, "q");
    std::vector<double> out(count);
    for (std::size_t k = 0; k < count; ++k) out[k] = tree_.clearance(q.data() + k * n);
    return to_numpy(std::move(out));
  }
  /// (m n): of the pairs of a sphere with a shape, `against` of them, then of two spheres, in each configuration.
  Result distances(const Doubles& q, const Indices& first, const Indices& second, std::size_t against) const {
    const std::size_t n = tree_.joints.size(), count = n ? q.size() / n : 0, pairs = first.size();
    checked(q, n * count, "q");
    known(first, tree_.spheres.size());
    checked(second, pairs, "second");
    known(second, std::max(tree_.spheres.size(), tree_.shapes.size()));
    std::vector<double> out(count * pairs);
    std::vector<collision::Place> places;
    std::vector<Eigen::Vector3d> centres;
    for (std::size_t k = 0; k < count; ++k) {
      tree_.forward(q.data() + k * n, places);
      tree_.centres(places, centres);
      for (std::size_t p = 0; p < pairs; ++p) {
        const auto s = first.data()[p], t = second.data()[p];
        out[k * pairs + p] = (p < against ? tree_.shapes[t].distance(centres[s]).value
                                          : (centres[s] - centres[t]).norm() - tree_.spheres[t].radius) -
                             tree_.spheres[s].radius;
      }
    }
    return to_numpy(std::move(out));
  }
  /// Centres (3 m) of one sphere in each configuration (m n).
  Result centres(const Doubles& q, const Indices& spheres) const {
    const std::size_t n = tree_.joints.size();
    checked(q, n * spheres.size(), "q");
    known(spheres, tree_.spheres.size());
    std::vector<double> out;
    std::vector<collision::Place> places;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
      const std::size_t s = spheres.data()[k];
      tree_.forward(q.data() + k * n, places);
      for (const auto& group : tree_.groups)
        if (group.first <= s && s < group.last) {
          const Eigen::Vector3d centre = tree_.of(places, group.joint) * tree_.spheres[s].centre;
          out.insert(out.end(), centre.data(), centre.data() + 3);
        }
    }
    return to_numpy(std::move(out));
  }
  /// Places (4 k) and numbers (2 k) of the pairs that are not proved: interval, first, second, self; tau and distance.
  /// Then the same of the least distance.
  nb::tuple shortfalls(const Doubles& coefficients, const Indices& counts, double margin) const {
    const std::size_t n = tree_.joints.size();
    PolynomialMotion motion(tree_, margin);
    std::size_t at = 0;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const std::size_t next = at + counts.data()[k] * n;
      if (counts.data()[k] < 1 || next > coefficients.size())
        throw std::invalid_argument("the counts add up to more coefficients than there are");
      motion.prove(static_cast<int>(k), coefficients.data() + at, static_cast<int>(counts.data()[k]));
      at = next;
    }
    std::vector<std::int64_t> places;
    std::vector<double> numbers;
    motion.shorts.push_back(motion.least);
    for (const auto& s : motion.shorts) {
      places.insert(places.end(), {s.interval, s.first, s.second, s.self});
      numbers.insert(numbers.end(), {s.tau, s.distance});
    }
    return nb::make_tuple(to_numpy(std::move(places)), to_numpy(std::move(numbers)));
  }
  bool motion_free(const Doubles& a, const Doubles& b, double margin, double resolution) const {
    return PolynomialMotion(tree_, margin).free(configuration(a), configuration(b), resolution);
  }
  Result connect(const Doubles& start, const Doubles& goal, const Doubles& lower, const Doubles& upper,
                 const Doubles& speeds, double range, std::uint64_t seed, std::size_t iterations, double seconds,
                 std::size_t shortcuts, double margin, double resolution) const {
    StraightMotions motions{PolynomialMotion(tree_, margin), resolution};
    const collision::Search search = {point(lower), point(upper), point(speeds), range, seed, iterations, seconds};
    collision::Path path = rrt_connect(motions, search, point(start), point(goal));
    std::vector<double> out;
    for (const auto& q : shortened(motions, std::move(path), search.speeds, seed, shortcuts))
      out.insert(out.end(), q.begin(), q.end());
    return to_numpy(std::move(out));
  }

 private:
  static void known(const Indices& numbers, std::size_t count) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (numbers.data()[i] < 0 || numbers.data()[i] >= static_cast<std::int64_t>(count))
        throw std::invalid_argument("an index is out of range");
  }
  static std::vector<int> narrow(const Indices& indices) {
    return std::vector<int>(indices.data(), indices.data() + indices.size());
  }
  static std::vector<std::pair<int, int>> pairs_of(const Indices& indices) {
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t i = 0; i + 1 < indices.size(); i += 2)
      pairs.emplace_back(static_cast<int>(indices.data()[i]), static_cast<int>(indices.data()[i + 1]));
    return pairs;
  }
  const double* configuration(const Doubles& q) const { return checked(q, tree_.joints.size(), "q"); }
  std::vector<double> point(const Doubles& q) const {
    const double* at = configuration(q);
    return {at, at + tree_.joints.size()};
  }

  collision::SphereTree tree_;
};

}  // namespace

void bind_collision(nb::module_& m) {
  nb::class_<SphereTree>(m, "SphereTree")
      .def(nb::init<const Indices&, const Indices&, const Doubles&, const Indices&, const Indices&, const Doubles&,
                    const Indices&, const Indices&, const Doubles&, const Indices&, const Doubles&>(),
           nb::arg("parents"), nb::arg("turns"), nb::arg("joints"), nb::arg("groups"), nb::arg("group_of"),
           nb::arg("spheres"), nb::arg("pairs"), nb::arg("kinds"), nb::arg("shapes"), nb::arg("triangles"),
           nb::arg("corners"))
      .def("clearances", &SphereTree::clearances, nb::arg("q"))
      .def("distances", &SphereTree::distances, nb::arg("q"), nb::arg("first"), nb::arg("second"), nb::arg("against"))
      .def("centres", &SphereTree::centres, nb::arg("q"), nb::arg("spheres"))
      .def("shortfalls", &SphereTree::shortfalls, nb::arg("coefficients"), nb::arg("counts"), nb::arg("margin"))
      .def("motion_free", &SphereTree::motion_free, nb::arg("a"), nb::arg("b"), nb::arg("margin"),
           nb::arg("resolution"))
      .def("connect", &SphereTree::connect, nb::arg("start"), nb::arg("goal"), nb::arg("lower"), nb::arg("upper"),
           nb::arg("speeds"), nb::arg("range"), nb::arg("seed"), nb::arg("iterations"), nb::arg("seconds"),
           nb::arg("shortcuts"), nb::arg("margin"), nb::arg("resolution"));
}

}  // namespace robotraj::native
