"""Programs of the compiled solver, and their refreshed numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj.native.build import load_native
from robotraj.native.engines.base import Engine
from robotraj.solvers.stagewise.matrices import native
from robotraj.solvers.stagewise.program import BlockProgram, StageProgram

if TYPE_CHECKING:
    from robotraj.native import Program as NativeProgram
    from robotraj.native import Term


def native_program(program: StageProgram, engine: Engine, threads: int) -> NativeProgram:
    """Copy a program into C++, its point functions evaluated by ``engine``.

    Parameters
    ----------
    program : StageProgram
    engine : Engine
    threads : int
        Number of threads that evaluate points; solutions are the same for any number.
    """
    made: NativeProgram = load_native().Program(
        program.nu,
        program.nx,
        program.equalities,
        program.inequalities,
        program.linear,
        program.shift,
        program.cost,
        program.constant,
        *program.jacobian,
        program.jacobian_constant,
        *program.hessian,
        [_term(part, engine) for part in program.blocks],
        threads,
        None if program.groups is None else program.groups.ravel(),
    )
    return made


def refresh(native: NativeProgram, program: StageProgram) -> None:
    """Write the numbers of a refreshed program (``Reduction.refreshed``) to the compiled one."""
    native.set_offsets(program.shift, program.constant)
    for number, part in enumerate(program.blocks):
        native.set_block_offsets(number, part.shift)
        native.set_constants(number, np.ascontiguousarray(part.block.constants.T).ravel())


def _term(part: BlockProgram, engine: Engine) -> Term:
    block = part.block
    made: Term = load_native().Term(
        engine.block(block.stage, block.count, block.costs),
        native(block.gather),
        part.shift,
        np.ascontiguousarray(block.constants.T).ravel(),
        native(block.scatter),
        block.weights if block.costs else None,
        part.gradient,
        part.jacobian,
        part.hessian,
    )
    return made
