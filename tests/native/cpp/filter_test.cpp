// The filter against its definition.
#include <random>
#include <utility>
#include <vector>

#include "check.hpp"
#include "interior_point/filter.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(the_filter_refuses_what_a_corner_is_at_least_as_good_as) {
  std::mt19937 random(0);
  std::uniform_int_distribution<int> level(0, 9);
  for (int round = 0; round < 200; ++round) {
    interior_point::Filter filter;
    std::vector<std::pair<int, int>> corners;
    for (int k = 0; k < 8; ++k) {
      corners.emplace_back(level(random), level(random));
      filter.add(corners.back().first, corners.back().second);
    }
    CHECK(filter.size() <= corners.size());
    for (int violation = 0; violation < 10; ++violation)
      for (int barrier = 0; barrier < 10; ++barrier) {
        bool accepted = true;
        for (const auto& [v, b] : corners) accepted = accepted && !(violation >= v && barrier >= b);
        CHECK(filter.accepts(violation, barrier) == accepted);
      }
  }
}

}  // namespace robotraj::tests
