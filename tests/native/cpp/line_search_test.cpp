// Accepted points against the conditions of the line search, and the corners that the filter adds for them.
#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(accepted_points_lower_the_violation_or_the_barrier_function) {
  for (const std::vector<double>& x : {its_start, std::vector<double>{1.2, 1.2, 4.8, 4.8}, {2.0, 3.0, 4.0, 1.5}}) {
    Started its(x);
    interior_point::LineSearch& search = its.algorithm.search;
    search.start();
    for (int iteration = 0; iteration < 25 && its.run.current->violation() > 1e-6; ++iteration) {
      interior_point::Iterate& at = *its.run.current;
      CHECK(its.run.direction.find(at, its.run.mu, its.run.step.get()));
      const double violation = at.violation(), barrier = at.barrier(its.run.mu);
      CHECK(search.search());
      interior_point::Iterate& trial = *its.run.trial;
      CHECK(trial.violation() <= (1.0 - 1e-5) * violation + 1e-13 ||
            trial.barrier(its.run.mu) <= barrier - 1e-8 * violation + 1e-13 * std::abs(barrier));
      // 1 - tau of every distance and multiplier is left.
      const double left = (1.0 - its.run.tau()) * (1.0 - 1e-9);
      for (int i = 0; i < 5; ++i) {
        CHECK(trial.below()[i] >= left * at.below()[i]);
        CHECK(trial.at->lower[i] >= left * at.at->lower[i]);
        if (i == 0) continue;
        CHECK(trial.above()[i] >= left * at.above()[i]);
        CHECK(trial.at->upper[i] >= left * at.at->upper[i]);
      }
      std::swap(its.run.current, its.run.trial);
    }
    CHECK(its.run.current->violation() <= 1e-6);
  }
}

ROBOTRAJ_TEST(a_point_that_was_given_up_is_accepted_no_more) {
  Started its;
  interior_point::LineSearch& search = its.algorithm.search;
  search.start();
  interior_point::Iterate& at = *its.run.current;
  const double violation = at.violation(), barrier = at.barrier(its.run.mu);
  search.give_up();
  CHECK(!search.accepts(violation, barrier));
  CHECK(!search.accepts(violation, barrier + 1.0));
  CHECK(search.accepts(0.5 * violation, barrier + 1.0));
  CHECK(search.accepts(violation, barrier - 1.0));
  CHECK(!search.accepts(0.5 * violation, std::nan("")));
  search.reset();
  CHECK(search.accepts(violation, barrier - 1e-8 * violation - 1e-9));
}

ROBOTRAJ_TEST(a_corner_of_no_consequence_shortens_five_steps_and_no_more) {
  const auto on_the_sphere = [](double x, double y, double z) {
    return std::vector<double>{x, y, z, std::sqrt(40.0 - x * x - y * y - z * z)};
  };
  // A corner of almost no violation and a better objective than the start's.
  std::vector<double> corner = on_the_sphere(1.2, 4.6, 3.9);
  corner[3] += 1e-11;
  Started its(corner);
  interior_point::LineSearch& search = its.algorithm.search;
  search.start();
  search.give_up();
  interior_point::start_cold(its.run, on_the_sphere(1.5, 3.5, 4.5).data());
  std::vector<double> moved;
  for (int iteration = 0; iteration < 7; ++iteration) {
    CHECK(its.run.direction.find(*its.run.current, its.run.mu, its.run.step.get()));
    CHECK(search.search());
    double most = 0.0;
    for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(its.run.trial->at->x[i] - its.run.current->at->x[i]));
    moved.push_back(most);
    std::swap(its.run.current, its.run.trial);
  }
  for (int iteration = 0; iteration < 5; ++iteration) CHECK(moved[iteration] < 1e-3);
  CHECK(moved[5] > 0.1);
}

ROBOTRAJ_TEST(a_full_step_of_a_chosen_parameter_is_taken_although_the_filter_refuses_it) {
  const auto beside_the_sphere = [](double x, double y, double z, double beside) {
    return std::vector<double>{x, y, z, std::sqrt(40.0 - x * x - y * y - z * z) + beside};
  };
  const auto moved = [&](bool free, double beside) {
    // A corner of almost no violation and a better objective than the start's.
    Started its(beside_the_sphere(1.2, 4.6, 3.9, 1e-11));
    interior_point::LineSearch& search = its.algorithm.search;
    search.start();
    search.give_up();
    interior_point::start_cold(its.run, beside_the_sphere(1.5, 3.5, 4.5, beside).data());
    search.free = free;
    CHECK(its.run.direction.find(*its.run.current, its.run.mu, its.run.step.get()));
    const bool taken = search.search();
    const interior_point::Vectors &from = its.run.current->at.get(), &to = its.run.trial->at.get();
    return taken ? (to.x[0] - from.x[0]) / its.run.step->x[0] : 0.0;
  };
  CHECK(std::abs(moved(true, 1e-2) - 1.0) < 1e-12);
  CHECK(moved(false, 1e-2) < 0.95);
  // The full step would violate the sphere more than ten times as much.
  CHECK(moved(true, 1e-4) < 0.95);
}

}  // namespace robotraj::tests
