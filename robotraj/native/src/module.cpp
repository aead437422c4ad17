// The Python face of the native solver: point functions and the stagewise program with its solver.
#include "bindings/bindings.hpp"

#include <casadi/config.h>
#include <pinocchio/config.hpp>

NB_MODULE(_native, m) {
  // What a script holds when the interpreter ends is no leak, and nothing that its user should have to read about.
  nanobind::set_leak_warnings(false);
  m.attr("PINOCCHIO_VERSION") = PINOCCHIO_VERSION;
  m.attr("CASADI_VERSION") = CASADI_VERSION_STRING;
  robotraj::native::bind_point_block(m);
  robotraj::native::bind_tape_block(m);
  robotraj::native::bind_stage_graph(m);
  robotraj::native::bind_casadi_block(m);
  robotraj::native::bind_sparse(m);
  robotraj::native::bind_chains(m);
  robotraj::native::bind_collision(m);
  robotraj::native::bind_ldl(m);
  robotraj::native::bind_nearest_planes(m);
  robotraj::native::bind_stage_system(m);
  robotraj::native::bind_vectors(m);
  robotraj::native::bind_solver(m);
  robotraj::native::bind_program(m);
}
