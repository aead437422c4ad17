// Every algorithm returns a serialised casadi::Function; names, shapes and units are documented in model.py.
#pragma once

#include <cstddef>
#include <string>

namespace robotraj {

struct SymbolicModel;

/// Frame of expression, numbered as pinocchio::ReferenceFrame: 0 WORLD, 1 LOCAL, 2 LOCAL_WORLD_ALIGNED.
using Reference = int;

// forward_dynamics.cpp
std::string forward_dynamics(const SymbolicModel& symbolic);

// inverse_dynamics.cpp
std::string inverse_dynamics(const SymbolicModel& symbolic);
std::string nonlinear_effects(const SymbolicModel& symbolic);
std::string gravity(const SymbolicModel& symbolic);

// mass.cpp
std::string mass_matrix(const SymbolicModel& symbolic);
std::string kinetic_energy(const SymbolicModel& symbolic);
std::string potential_energy(const SymbolicModel& symbolic);
std::string center_of_mass(const SymbolicModel& symbolic);
std::string centroidal_momentum(const SymbolicModel& symbolic);

// frames.cpp
std::string frame_placement(const SymbolicModel& symbolic, std::size_t frame);
std::string frame_velocity(const SymbolicModel& symbolic, std::size_t frame, Reference reference);
std::string frame_acceleration(const SymbolicModel& symbolic, std::size_t frame, Reference reference);
std::string frame_jacobian(const SymbolicModel& symbolic, std::size_t frame, Reference reference);

// configuration.cpp
std::string integrate(const SymbolicModel& symbolic);
std::string difference(const SymbolicModel& symbolic);
std::string configuration_rate(const SymbolicModel& symbolic);

}  // namespace robotraj
