// The Python module of the native solver: point functions and the stagewise program with its solver.
#include "bindings/bindings.hpp"

#include <casadi/config.h>
#include <pinocchio/config.hpp>

NB_MODULE(_native, m) {
  // Objects that a script holds when the interpreter ends are no leaks: users need no warning of them.
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
  robotraj::native::bind_solver(m);
  robotraj::native::bind_program(m);
}
