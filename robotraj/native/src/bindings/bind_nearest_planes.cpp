// Planes between the nearest shapes at many configurations, from plain arrays.
#include "arrays.hpp"
#include "bindings.hpp"
#include "collision/nearest_planes.hpp"
#include "shapes.hpp"

#include <algorithm>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

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

void bind_nearest_planes(nb::module_& m) {
  nb::class_<NearestPlanes>(m, "NearestPlanes")
      .def(nb::init<const Indices&, const Doubles&, const Indices&, const Doubles&, const Indices&, const Doubles&,
                    const Indices&, const Indices&, const Indices&, const Doubles&>(),
           nb::arg("joints"), nb::arg("spheres"), nb::arg("kinds"), nb::arg("shapes"), nb::arg("triangles"),
           nb::arg("corners"), nb::arg("first"), nb::arg("second"), nb::arg("groups"), nb::arg("rotations"))
      .def("find", &NearestPlanes::find, nb::arg("places"), nb::arg("poses"), nb::arg("count"));
}

}  // namespace robotraj::native
