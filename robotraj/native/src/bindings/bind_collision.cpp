// Spheres on a tree of joints among obstacles: distances, straight motions and paths, from plain arrays.
#include "arrays.hpp"
#include "bindings.hpp"
#include "collision/nearest_planes.hpp"
#include "collision/polynomial_motion.hpp"
#include "collision/search/paths.hpp"

#include <Eigen/Geometry>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

using Row = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

constexpr std::size_t JOINT_NUMBERS = 15, SHAPE_NUMBERS = 16;

std::vector<collision::Joint> joints_of(const Indices& parents, const Indices& turns, const Doubles& numbers) {
  checked(turns, parents.size(), "turns");
  const double* at = checked(finite(numbers, "a joint"), JOINT_NUMBERS * parents.size(), "the numbers of the joints");
  std::vector<collision::Joint> joints;
  for (std::size_t i = 0; i < parents.size(); ++i, at += JOINT_NUMBERS)
    joints.push_back({narrow(parents.data()[i]), turns.data()[i] != 0, Eigen::Map<const Eigen::Vector3d>(at),
                      Row(at + 3), Eigen::Map<const Eigen::Vector3d>(at + 12)});
  return joints;
}

std::vector<collision::Sphere> spheres_of(const Doubles& numbers) {
  std::vector<collision::Sphere> spheres;
  finite(numbers, "a sphere");
  for (const double* at = numbers.data(); at != numbers.data() + numbers.size() / 4 * 4; at += 4)
    spheres.push_back({Eigen::Map<const Eigen::Vector3d>(at), at[3]});
  return spheres;
}

/// Vertices are in the frames of the shapes; triangles have three each, counter-clockwise from outside.
std::vector<collision::Shape> shapes_of(const Indices& kinds, const Doubles& numbers, const Indices& triangles,
                                        const Doubles& corners) {
  const double* at =
      checked(finite(numbers, "an obstacle"), SHAPE_NUMBERS * kinds.size(), "the numbers of the obstacles");
  checked(triangles, kinds.size(), "triangles");
  std::vector<collision::Shape> shapes;
  const double *corner = finite(corners, "a corner").data(), *end = corner + corners.size();
  for (std::size_t i = 0; i < kinds.size(); ++i, at += SHAPE_NUMBERS) {
    if (kinds.data()[i] < 0 || kinds.data()[i] > static_cast<std::int64_t>(collision::Kind::convex))
      throw std::invalid_argument("an obstacle is of an unknown kind");
    const auto kind = static_cast<collision::Kind>(kinds.data()[i]);
    shapes.push_back(
        {kind, Row(at), Eigen::Map<const Eigen::Vector3d>(at + 9), Eigen::Map<const Eigen::Vector4d>(at + 12), {}});
    for (std::int64_t t = 0; t < triangles.data()[i]; ++t, corner += 9) {
      if (end - corner < 9) throw std::invalid_argument("an obstacle has fewer corners than its triangles need");
      collision::Triangle triangle;
      for (int k = 0; k < 3; ++k) triangle.corners[k] = Eigen::Map<const Eigen::Vector3d>(corner + 3 * k);
      const auto& c = triangle.corners;
      triangle.normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      shapes.back().triangles.push_back(triangle);
    }
  }
  return shapes;
}

using collision::PolynomialMotion;
using collision::StraightMotions;
class SphereTree {
 public:
  SphereTree(const Indices& parents, const Indices& turns, const Doubles& joints, const Indices& groups,
             const Indices& group_of, const Doubles& spheres, const Indices& pairs, const Indices& kinds,
             const Doubles& shapes, const Indices& triangles, const Doubles& corners)
      : tree_(joints_of(parents, turns, joints), narrow(groups), narrow(group_of), spheres_of(spheres), pairs_of(pairs),
              shapes_of(kinds, shapes, triangles, corners)) {}

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
    checked(second, pairs, "second");
    for (std::size_t p = 0; p < pairs; ++p) {
      known(first.data()[p], tree_.spheres.size());
      known(second.data()[p], p < against ? tree_.shapes.size() : tree_.spheres.size());
    }
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
    std::vector<double> out;
    std::vector<collision::Place> places;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
      const std::size_t s = known(spheres.data()[k], tree_.spheres.size());
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
    const double* at = finite(coefficients, "a motion").data();
    std::size_t left = coefficients.size() / std::max<std::size_t>(1, n);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const std::int64_t count = counts.data()[k];
      if (count < 1 || static_cast<std::size_t>(count) > left)
        throw std::invalid_argument("the counts add up to more coefficients than there are");
      motion.prove(static_cast<int>(k), at, static_cast<int>(count));
      at += count * n;
      left -= count;
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
    if (!(range > 0.0)) throw std::invalid_argument("the range is not positive");
    StraightMotions motions{PolynomialMotion(tree_, margin), resolution};
    const collision::Search search = {point(lower), point(upper), point(speeds), range, seed, iterations, seconds};
    collision::Path path = rrt_connect(motions, search, point(start), point(goal));
    std::vector<double> out;
    for (const auto& q : shortened(motions, std::move(path), search.speeds, seed, shortcuts))
      out.insert(out.end(), q.begin(), q.end());
    return to_numpy(std::move(out));
  }

 private:
  static std::size_t known(std::int64_t number, std::size_t count) {
    if (number < 0 || number >= static_cast<std::int64_t>(count))
      throw std::invalid_argument("an index is out of range");
    return static_cast<std::size_t>(number);
  }
  static std::vector<std::pair<int, int>> pairs_of(const Indices& indices) {
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t i = 0; i + 1 < indices.size(); i += 2)
      pairs.emplace_back(narrow(indices.data()[i]), narrow(indices.data()[i + 1]));
    return pairs;
  }
  const double* configuration(const Doubles& q) const { return checked(q, tree_.joints.size(), "q"); }
  std::vector<double> point(const Doubles& q) const {
    const double* at = configuration(finite(q, "a configuration"));
    return {at, at + tree_.joints.size()};
  }

  collision::SphereTree tree_;
};

constexpr std::size_t PLACE_NUMBERS = 12;

collision::Place place_of(const double* at) { return {Row(at), Eigen::Map<const Eigen::Vector3d>(at + 9)}; }

class NearestPlanes {
 public:
  NearestPlanes(const Indices& joints, const Doubles& spheres, const Indices& kinds, const Doubles& shapes,
                const Indices& triangles, const Doubles& corners, const Indices& first, const Indices& second,
                const Indices& groups, const Doubles& rotations) {
    planes_.spheres = spheres_of(spheres);
    planes_.shapes = shapes_of(kinds, shapes, triangles, corners);
    planes_.first = copied(first);
    planes_.second = copied(second);
    checked(joints, planes_.spheres.size(), "the joints of the spheres");
    planes_.joints.assign(joints.data(), joints.data() + joints.size());
    checked(second, first.size(), "second");
    known(first.data(), first.data() + first.size(), planes_.spheres.size());
    const std::size_t count = groups.size() / 4;
    checked(groups, 4 * count, "groups");
    const double* rotation = checked(rotations, 9 * count, "the rotations of the groups");
    std::int64_t begin = 0;
    for (const std::int64_t* at = groups.data(); at != groups.data() + groups.size(); at += 4, rotation += 9) {
      const std::int64_t end = at[0];
      if (end <= begin || end > static_cast<std::int64_t>(first.size()) || at[1] < 1 || at[1] > end - begin ||
          at[3] < 0)
        throw std::invalid_argument("a group is empty, has too few pairs, or is on an unknown joint");
      known(second.data() + begin, second.data() + end, at[2] ? planes_.spheres.size() : planes_.shapes.size());
      planes_.groups.push_back({static_cast<std::size_t>(begin), static_cast<std::size_t>(end),
                                static_cast<std::size_t>(at[1]), at[2] != 0, static_cast<std::size_t>(at[3]),
                                Row(rotation)});
      begin = end;
    }
    for (const auto joint : planes_.joints) last_joint_ = std::max(last_joint_, joint);
    for (const auto& group : planes_.groups) last_joint_ = std::max(last_joint_, group.common);
  }

  nb::tuple find(const Doubles& places, const Doubles& poses, std::size_t count) {
    if (count > places.size()) throw std::invalid_argument("there are more configurations than places");
    const std::size_t joints = count ? places.size() / (PLACE_NUMBERS * count) : 0, shapes = planes_.shapes.size();
    checked(places, PLACE_NUMBERS * joints * count, "places");
    if (count && joints <= last_joint_) throw std::invalid_argument("a sphere is on a joint without a place");
    const double *at = places.data(), *pose = checked(poses, PLACE_NUMBERS * shapes * count, "poses");
    std::vector<double> distances, first;
    std::vector<collision::Place> every(joints);
    std::vector<collision::PairPlane> found;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < joints; ++j, at += PLACE_NUMBERS) every[j] = place_of(at);
      for (std::size_t s = 0; s < shapes; ++s, pose += PLACE_NUMBERS) {
        const collision::Place placed = place_of(pose);
        planes_.shapes[s].rotation = placed.rotation;
        planes_.shapes[s].position = placed.position;
      }
      planes_.measure(every.data(), distances);
      if (k == 0) first = distances;
      planes_.planes(every.data(), distances, found);
    }
    std::vector<std::int64_t> pairs;
    std::vector<double> numbers;
    for (const auto& each : found) {
      pairs.push_back(each.pair);
      numbers.insert(numbers.end(), {each.normal[0], each.normal[1], each.normal[2], each.offset});
    }
    return nb::make_tuple(to_numpy(std::move(first)), to_numpy(std::move(pairs)), to_numpy(std::move(numbers)));
  }

 private:
  static void known(const std::int64_t* begin, const std::int64_t* end, std::size_t count) {
    for (; begin != end; ++begin)
      if (*begin < 0 || *begin >= static_cast<std::int64_t>(count))
        throw std::invalid_argument("a pair has an unknown shape");
  }

  collision::NearestPlanes planes_;
  std::size_t last_joint_ = 0;
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
  nb::class_<NearestPlanes>(m, "NearestPlanes")
      .def(nb::init<const Indices&, const Doubles&, const Indices&, const Doubles&, const Indices&, const Doubles&,
                    const Indices&, const Indices&, const Indices&, const Doubles&>(),
           nb::arg("joints"), nb::arg("spheres"), nb::arg("kinds"), nb::arg("shapes"), nb::arg("triangles"),
           nb::arg("corners"), nb::arg("first"), nb::arg("second"), nb::arg("groups"), nb::arg("rotations"))
      .def("find", &NearestPlanes::find, nb::arg("places"), nb::arg("poses"), nb::arg("count"));
}

}  // namespace robotraj::native
