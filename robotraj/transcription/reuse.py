"""Reuse of a transcription for a problem that differs only in numbers, or for another guess.

These are the ends of phases, the values of fixed parameters, and bounds of links such as the length of a step.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.row import Row
from robotraj.native.engines.base import Engine
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.collocation.end_functions import fixed_values
from robotraj.transcription.collocation.index_reduction import determined_at_ends
from robotraj.transcription.collocation.invariants import determined_invariants
from robotraj.transcription.interval_limits.added_rows import with_added_states
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.layout import PhaseLayout, Scalar
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Scalars
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.smoothness.sticking import acceleration_weights
from robotraj.transcription.transcribe import bounds_of, start_of


def transcribed_again(
    nlp: Nlp,
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    engine: Engine | None,
    interval_limits: ConstraintGeneration,
    smoothing: float,
    w: Array,
) -> Nlp | None:
    """Return an NLP with the numbers of another problem: bounds, constants and the start of the solver change.

    Parameters
    ----------
    nlp : Nlp
    problem : Problem
        A problem whose phases share their equations with those of ``nlp``, by ``Phase.with_`` or ``sharing``.
    mesh, engine, interval_limits, smoothing
        See ``transcribe``.
    w : ndarray (n_w,)
        Start of the solver, in physical units.

    Returns
    -------
    Nlp or None
        An NLP with the point functions and scales of ``nlp``; None where more than the numbers differs.
    """
    before = nlp.problem
    meshes = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)
    alike = (
        len(before.phases) == len(problem.phases) == len(meshes)
        and _alike_links(before, problem)
        and (engine is None or engine == nlp.engine)
        and interval_limits == nlp.interval_limits
        and smoothing == nlp.smoothing
        and all(_alike(*each) for each in zip(before.phases, problem.phases, nlp.layouts, strict=True))
        and all(layout.mesh == own for layout, own in zip(nlp.layouts, meshes, strict=True))
        and not any(isinstance(m, MovingMesh) or isinstance(s, OneStep) for m in meshes for s in m.given)
        and len(nlp.free) == len(w)
    )
    if not alike:
        return None
    layouts = tuple(map(_with_parameters, nlp.layouts, problem.phases))
    blocks = tuple(_with_scalars(block, layouts) for block in nlp.blocks)
    bounds = bounds_of(problem, layouts, interval_limits)
    variables = nlp.free.bounded(bounds)
    guess = np.clip(w, variables.lower, variables.upper)
    rows = _with_links(nlp.loose_rows or nlp.rows, problem)
    again = replace(
        nlp,
        problem=problem,
        layouts=layouts,
        variables=variables,
        guess=guess,
        rows=rows,
        blocks=blocks if any(map(operator.is_not, blocks, nlp.blocks)) else nlp.blocks,
        loose_rows=None,
        margins={},
    )
    return _with_functions(again, nlp) if again.blocks is nlp.blocks else again


def sharing(phase: Phase, known: Phase) -> Phase:
    """Return a phase with the equations and rows of a known one, if both differ only in numbers.

    These are the ends and the values of fixed parameters. Otherwise the phase itself is returned. Functions compare by
    identity, so phases with equal lambdas from several calls differ.
    """
    if not same_but_numbers(phase, known):
        return phase
    shared = known.with_(start=phase.start, end=phase.end, parameters=phase.parameters)
    return shared if shared.dae is known.dae else phase


def same_but_numbers(phase: Phase, known: Phase) -> bool:
    """Whether two phases differ at most in their ends and in the values of fixed parameters."""
    numbers = "start", "end", "parameters"
    if type(phase) is not type(known) or phase.design or phase.parameter_names != known.parameter_names:
        return False
    return all(_are_equal(phase, known, entry.name) for entry in fields(phase) if entry.name not in numbers)


def _are_equal(phase: Phase, known: Phase, name: str) -> bool:
    mine, other = getattr(phase, name), getattr(known, name)
    try:
        return mine is other or bool(mine == other)
    except ValueError:
        # Arrays have no single truth value.
        return False


def started_at(nlp: Nlp, guess: InitialGuess) -> Nlp:
    """Return the NLP with another start; blocks, scales and functions are those of ``nlp``."""
    start = start_of(nlp.problem, nlp.layouts, nlp.link_columns, nlp.variables, guess)
    return continued_at(nlp, with_added_states(nlp, start))


def continued_at(nlp: Nlp, w: Array) -> Nlp:
    """Return the NLP with the start w (n_w,) in physical units; blocks, scales and functions are those of ``nlp``."""
    return _with_functions(replace(nlp, guess=w), nlp)


def _with_functions(again: Nlp, nlp: Nlp) -> Nlp:
    """Copy the assembled functions, whose preparation was counted in the first plan."""
    if "functions" in nlp.__dict__:
        again.__dict__["functions"] = replace(nlp.functions, preparing=0.0)
    return again


def _alike(before: Phase, now: Phase, layout: PhaseLayout) -> bool:
    """Whether two phases share everything but their ends and the values of fixed parameters."""
    if before is now:
        return True
    same = before.dae is now.dae and before.rows is now.rows and before.duration_bounds == now.duration_bounds
    same = same and np.array_equal(acceleration_weights(before), acceleration_weights(now))
    if not same or not before.parameter_bounds.alike(now.parameter_bounds):
        return False
    # The ends determine which rows impose an invariant, or an equality with its rates.
    pairs = zip(determined_invariants(before), determined_invariants(now), strict=True)
    invariants = all(np.array_equal(one, other) for one, other in pairs)
    return invariants and determined_at_ends(before, layout) == determined_at_ends(now, layout)


def _alike_links(before: Problem, now: Problem) -> bool:
    """Whether two problems have the same links but for the values of bounds of rows."""
    given = [tuple(link.without_numbers() for link in problem.links) for problem in (before, now)]
    if given[0] != given[1]:
        return False
    rows = [[row for link in problem.bound_links for row in link.rows] for problem in (before, now)]
    return len(rows[0]) == len(rows[1]) and all(map(_alike_rows, *rows))


def _alike_rows(row: Row, other: Row) -> bool:
    """Whether two rows differ at most in the values of their bounds."""
    sides = [(np.isfinite(each.lower), np.isfinite(each.upper), each.lower == each.upper) for each in (row, other)]
    return sides[0] == sides[1] and replace(row, lower=0.0, upper=0.0) == replace(other, lower=0.0, upper=0.0)


def _with_links(rows: Scalars, problem: Problem) -> Scalars:
    """Return the rows of an NLP with the bounds of the problem's links, whose rows are the last ones."""
    of_links = [row for link in problem.bound_links for row in link.rows]
    if not of_links:
        return rows
    lower, upper = (
        np.append(whole[: -len(of_links)], [getattr(row, side) for row in of_links])
        for side, whole in (("lower", rows.lower), ("upper", rows.upper))
    )
    if np.array_equal(lower, rows.lower) and np.array_equal(upper, rows.upper):
        return rows
    return replace(rows, lower=lower, upper=upper)


def _with_parameters(layout: PhaseLayout, phase: Phase) -> PhaseLayout:
    """Return a layout with the values of the phase's fixed parameters."""
    pairs = zip(layout.parameters, phase.parameter_bounds.lower, strict=True)
    parameters = tuple(scalar if scalar.column is not None else Scalar(None, float(low)) for scalar, low in pairs)
    return layout if parameters == layout.parameters else replace(layout, parameters=parameters)


def _with_scalars(block: Block, layouts: Sequence[PhaseLayout]) -> Block:
    """Return a block with the fixed scalars of its phases."""
    fixed = np.concatenate([np.zeros(0), *(fixed_values(layouts[i]) for i in block.phases)])
    first = len(block.constants) - fixed.size
    if np.all(block.constants[first:] == fixed[:, None]):
        return block
    return replace(block, constants=np.vstack([block.constants[:first], np.tile(fixed[:, None], block.count)]))
