// The parts of the Python module, one function a file.
#pragma once

#include <nanobind/nanobind.h>

namespace robotraj::native {

void bind_point_block(nanobind::module_& m);
void bind_tape_block(nanobind::module_& m);
void bind_stage_graph(nanobind::module_& m);
void bind_casadi_block(nanobind::module_& m);
void bind_sparse(nanobind::module_& m);
void bind_chains(nanobind::module_& m);
void bind_collision(nanobind::module_& m);
void bind_ldl(nanobind::module_& m);
void bind_solver(nanobind::module_& m);
void bind_program(nanobind::module_& m);

}  // namespace robotraj::native
