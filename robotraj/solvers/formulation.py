"""The form of an NLP for the compiled solver: in stages, or assembled as a whole.

A problem that couples only neighbouring intervals is written in stages, and a Riccati recursion solves its Newton
systems. Contacts, closed gaits, design parameters, integrals and shooting couple distant intervals or make stages
rank deficient. Such a problem is assembled, and its Newton systems are factorised as sparse matrices.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.time_left import require
from robotraj.solvers.base import BARRIER, SMALL_BARRIER
from robotraj.solvers.stagewise.multipliers import recover
from robotraj.solvers.stagewise.reduction import Reduction, reduce
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.schemes.onestep import OneStep

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.solvers.assembled.program import Assembled
    from robotraj.transcription.layout import PhaseLayout
    from robotraj.transcription.nlp import Nlp

Formulation: TypeAlias = "Reduction | Assembled"

WIDEST = 10_000
"""Unknowns times equalities of a stage above which a fully pivoted elimination is slower than a sparse one."""
ROW_CORRECTION = 1e-8
"""Regularisation of the rows of an assembled problem, times mu^(1/4).

Rows may be redundant, and near straight knees they are almost dependent. Without it steps of multipliers are unbounded
there.
"""
FINE_CORRECTIONS = {"first_correction": 1e-6, "correction_increase": 4.5, "correction_decrease": 0.1}
"""Corrections of inertia for robots in stages, near the least ones that are needed (``benchmarks/barrier.md``).

Larger ones shorten steps along the negative curvature. Systems may start so far away that shorter steps are better, and
the conflicts of an infeasible flight were not found with the finer ones.
"""
SECONDS_OF_BLOCK = 5e-3
"""Processor time of writing one point function of an NLP in stages [s]; hundreds of phases have a thousand."""
Keys = NDArray[np.int64]
KINDS = 8
"""Keys are KINDS * number + kind."""


def formulate(nlp: Nlp) -> Formulation:
    """Write an NLP in stages where these are narrow and of full rank, else as a whole.

    Raises
    ------
    LimitReached
        Writing many phases in stages takes longer than the time that the plan has left.
    """
    if _joins_neighbours(nlp):
        require(SECONDS_OF_BLOCK * len(nlp.blocks), 0.0)
        reduction = reduce(nlp)
        program = reduction.program
        unknowns = program.nu + program.nx
        if np.all(program.equalities <= unknowns) and np.max(unknowns * program.equalities) <= WIDEST:
            return reduction
    return assembled(nlp)


def assembled(nlp: Nlp) -> Assembled:
    """Write an NLP as a whole. The module is imported on first use: arms seldom need it."""
    from robotraj.solvers.assembled.program import assemble

    return assemble(nlp)


def first_barrier(formulation: Formulation) -> float:
    """Return the first barrier parameter of a solve from a guess."""
    phases = formulation.nlp.problem.phases
    legs = any(phase.contacts and phase.robot is not None and phase.robot.root == "floating" for phase in phases)
    return SMALL_BARRIER if legs and not isinstance(formulation, Reduction) else BARRIER


def options(formulation: Formulation) -> dict[str, float]:
    """Return the options of the compiled solver that the formulation requires."""
    if not isinstance(formulation, Reduction):
        return {"row_correction": ROW_CORRECTION, "least_row_correction": ROW_CORRECTION}
    return FINE_CORRECTIONS if all(phase.robot for phase in formulation.nlp.problem.phases) else {}


def multipliers(formulation: Formulation, y: Array, lam: Array) -> tuple[Array, Array]:
    """Return the multipliers of the NLP's rows (n_g,) and bounds (n_w,), in physical units.

    Parameters
    ----------
    formulation : Formulation
    y : ndarray (n_y,)
        Solution of the program.
    lam : ndarray (n_rows,)
        Multipliers of its rows.
    """
    if isinstance(formulation, Reduction):
        return recover(formulation, y, lam)
    return formulation.multipliers(y, lam)


def carried(known: Formulation, lam: Array, new: Formulation) -> Array | None:
    """Return multipliers of an earlier program for the rows of a similar one; None where the forms differ."""
    if isinstance(known, Reduction):
        return carried_over(known, lam, new) if isinstance(new, Reduction) else None
    return None if isinstance(new, Reduction) else new.carried_over(known, lam)


def _joins_neighbours(nlp: Nlp) -> bool:
    phases = all(map(_couples_neighbours, nlp.problem.phases, nlp.layouts))
    links = (link.phases for link in nlp.problem.bound_links)
    return phases and all(max(each) - min(each) == 1 for each in links)


def _couples_neighbours(phase: Phase, layout: PhaseLayout) -> bool:
    """Whether the rows and unknowns of a phase couple only neighbouring intervals."""
    distant = (
        isinstance(layout.scheme, OneStep)
        or isinstance(layout.mesh, MovingMesh)
        or phase.contacts
        or phase.dae.invariants
        or any(parameter.column is not None for parameter in layout.parameters)
        or phase.rows.integrals
    )
    return not distant


def carried_over(known: Reduction, multipliers: Array, new: Reduction) -> Array:
    """Return multipliers of a program for the equal rows of another one, zero for all other rows.

    Parameters
    ----------
    known : Reduction
    multipliers : ndarray (n_rows,)
        Multipliers of the rows of its program.
    new : Reduction
        Reduction of an NLP whose first columns and rows are those of the known one.
    """
    old_keys, new_keys = _keys(known), _keys(new)
    order = np.argsort(old_keys)
    at = np.minimum(np.searchsorted(old_keys[order], new_keys), old_keys.size - 1)
    found = order[at]
    return np.where(old_keys[found] == new_keys, multipliers[found], 0.0)


def _keys(reduction: Reduction) -> Keys:
    """Return a key for every row of a program: dynamics of a state, a row of the NLP or one side of it, a bound."""
    form, program, slots = reduction.form, reduction.program, reduction.slots
    rows, columns = program.form_rows, program.bound_columns
    carried = slots.carried[:, 0]
    first_slot = np.argsort(slots.base, kind="stable")
    column = first_slot[np.searchsorted(slots.base[first_slot], carried, side="right") - 1]
    stage = slots.first[column] + carried - slots.base[column]
    keys = np.empty(rows.size, dtype=np.int64)
    keys[: carried.size] = KINDS * (column.astype(np.int64) * len(program.nu) + stage)
    path = rows >= 0
    mine = rows[path]
    above = ~np.isfinite(form.row_lower[mine])
    limits, bounds = form.limit_of[mine], form.bound_of[mine]
    own = (limits == mine) | (bounds < 0)
    keys[path] = np.where(own, KINDS * np.where(limits == mine, mine, limits) + 1 + above, KINDS * bounds + 3 + above)
    fixed = columns >= 0
    keys[fixed] = KINDS * columns[fixed].astype(np.int64) + 5
    return keys
