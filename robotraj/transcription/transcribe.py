"""Transcription of a problem on meshes to a nonlinear program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.native.engines.base import Engine, VirtualMachine
from robotraj.problem.constraints.base import Where
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess, with_copies
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.collocation import collocate
from robotraj.transcription.collocation.ends import (
    end_constraint_blocks,
    link_block,
    link_unknowns,
    mayer_block,
    start_block,
    start_equalities_block,
    widen,
)
from robotraj.transcription.collocation.index_reduction import carried_equalities
from robotraj.transcription.interval_limits.bernstein_bounds import (
    columns_beside_rows,
    covered_in,
    impose_on_controls,
    on_coefficients,
)
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.interval_limits.rate_bounds import impose_on_rates
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.numbering import lay_out
from robotraj.transcription.scalar_table import ColumnBound, Entry, Scalars, ScalarTable
from robotraj.transcription.scaling import scales
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.smoothness.alternation import alternation_block

INSIDE = 1e-9
"""Distance from the ends of an interval at which one-sided values are sampled, as a fraction of its length."""


class KnownStart(NamedTuple):
    """A start of the solver with known scales, which may have further entries for rows that are added later.

    Attributes
    ----------
    w, scale : ndarray (n_w,)
        Decision vector in physical units, and the scales of its columns.
    row_scale : ndarray (n_g,)
    """

    w: Array
    scale: Array
    row_scale: Array


def transcribe(
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    guess: InitialGuess | KnownStart,
    engine: Engine | None = None,
    interval_limits: ConstraintGeneration | None = None,
    smoothing: float = 0.0,
) -> Nlp:
    """Transcribe a problem by the schemes of its meshes.

    Parameters
    ----------
    problem : Problem
    mesh : Mesh or sequence of Mesh
        One mesh for all phases, or one for each.
    guess : InitialGuess or KnownStart
        Start of the solver, such as ``rt.guess.StraightLine()``. Rows and variables are scaled there, unless the scales
        are known.
    engine : Engine, optional
        Engine that evaluates the point functions; ``rt.engines.VirtualMachine()`` by default.
    interval_limits : ConstraintGeneration, optional
        Method that imposes limits between the collocation points. The default,
        ``rt.interval_limits.ConstraintGeneration()``, adds rows only after a first solution.
    smoothing : float
        Weight of the mean square of bounded variables beside a duration (``transcription.smoothness``).

    Returns
    -------
    Nlp
        With a name for every row and variable; ``rt.Ipopt().solve(nlp)`` solves it.
    """
    engine = engine or VirtualMachine()
    interval_limits = interval_limits or ConstraintGeneration()
    as_tapes = engine.separate_torques
    meshes = meshes_of(problem, mesh)
    if any(isinstance(scheme, OneStep) for m in meshes for scheme in m.given):
        from robotraj.transcription.shooting.explicit_dynamics import explicit

        problem = explicit(problem, meshes)
    columns, rows, linear = ScalarTable(), ScalarTable(), Triplets()
    layouts = tuple(
        lay_out(phase, i, m, columns) for i, (phase, m) in enumerate(zip(problem.phases, meshes, strict=True))
    )
    blocks: list[Block] = []
    points = []
    for i, (phase, layout) in enumerate(zip(problem.phases, layouts, strict=True)):
        collocated = not isinstance(layout.scheme, OneStep)
        known = carried_equalities(problem.phases, i, problem.bound_links)
        if not collocated:
            from robotraj.transcription.shooting.shooting import shoot

            point, more = shoot(phase, i, layout, columns, rows, linear)
            points.append(point)
            blocks += more
        else:
            points.append(collocate(phase, i, layout, rows, linear, as_tapes, interval_limits, known, smoothing))
            smooth = alternation_block(phase, layout, smoothing)
            blocks += [] if smooth is None else [smooth]
        impose_on_controls(interval_limits, phase, i, layout, rows, linear)
        impose_on_rates(phase, i, layout, rows, linear)
        ends = end_constraint_blocks(phase, i, layout, rows, as_tapes)
        chosen = (
            start_equalities_block(phase, i, layout, rows, known, as_tapes)
            if collocated and known is not None
            else None
        )
        started = start_block(problem.phases, i, layout, problem.bound_links, rows, as_tapes)
        ends += [block for block in (chosen, started, mayer_block(phase, layout, as_tapes)) if block]
        blocks += [replace(block, phases=(i,)) for block in ends]
    unknowns = tuple(link_unknowns(link, columns) for link in problem.bound_links)
    blocks += [
        replace(link_block(link, problem.phases, layouts, own, rows, as_tapes), phases=link.phases)
        for link, own in zip(problem.bound_links, unknowns, strict=True)
    ]
    free, constraints = columns.finish(), rows.finish()
    variables = free.bounded(bounds_of(problem, layouts, interval_limits))
    shape = (len(constraints), len(variables))
    every = [_finish_points(block, gather, scatter, shape) for block, gather, scatter in points]
    every += [widen(block, *shape) for block in blocks]
    for block in every:
        block.stage.as_tapes = as_tapes
    matrix = linear.matrix(shape)
    if isinstance(guess, KnownStart):
        start, scale, of_rows = guess.w[: shape[1]], guess.scale[: shape[1]], guess.row_scale[: shape[0]]
    else:
        start = start_of(problem, layouts, unknowns, variables, guess)
        systems = [layout for layout, phase in zip(layouts, problem.phases, strict=True) if phase.robot is None]
        of_states = [run.states.ravel() for layout in systems for run in layout.runs]
        of_others = [*(run.controls.ravel() for layout in layouts for run in layout.runs), *unknowns]
        scale, of_rows = scales(every, matrix, variables, constraints, start, (of_states, of_others))
    return Nlp(
        problem,
        layouts,
        unknowns,
        variables,
        constraints,
        tuple(every),
        matrix,
        scale,
        of_rows,
        start,
        free,
        engine,
        interval_limits,
        smoothing,
    )


def start_of(
    problem: Problem,
    layouts: Sequence[PhaseLayout],
    link_columns: Sequence[NDArray[np.int_]],
    variables: Scalars,
    guess: InitialGuess,
) -> Array:
    """Return the decision vector of a guess, clipped to the bounds, (n_w,)."""
    known = guess.prepared(problem)
    start = _guess(problem, layouts, known, len(variables))
    for i, (link, own) in enumerate(zip(problem.bound_links, link_columns, strict=True)):
        values = known.of_link(link, i)
        start[own] = [values.get(unknown.name, 0.0) for unknown in link.unknowns]
    return np.clip(start, variables.lower, variables.upper)


def bounds_of(
    problem: Problem, layouts: Sequence[PhaseLayout], interval_limits: ConstraintGeneration
) -> list[ColumnBound]:
    """Return the bounds of columns: the ends first, then the rows of single variables."""
    bounds = []
    for i, (phase, layout) in enumerate(zip(problem.phases, layouts, strict=True)):
        bounds += _bounds(phase, i, layout, covered_in(interval_limits, phase, layout))
    return bounds


def meshes_of(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> tuple[Mesh, ...]:
    """Return one mesh a phase.

    Raises
    ------
    InputError
        There are fewer or more meshes than phases.
    """
    meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
    if len(meshes) != len(problem.phases):
        raise InputError(f"The problem has {len(problem.phases)} phases but {len(meshes)} meshes were given.")
    return meshes


def _finish_points(block: Block, gather: Triplets, scatter: Triplets, shape: tuple[int, int]) -> Block:
    count, stage = block.count, block.stage
    return replace(
        block,
        gather=gather.matrix((stage.inputs * count, shape[1])),
        scatter=scatter.matrix((shape[0], stage.outputs * count)),
    )


def _bounds(phase: Phase, index: int, layout: PhaseLayout, covered: frozenset[str]) -> list[ColumnBound]:
    """Return the ends of the phase and the rows of single variables as bounds of columns.

    Variables that are ``covered`` between the points have bounds on ``columns_beside_rows``.
    """
    bounds = []
    for which, knot, given in (("start", 0, phase.start_bounds), ("end", -1, phase.end_bounds)):
        for i, variable in enumerate(phase.dae.states):
            entry = Entry(index, f"{which} {variable.quantity}", variable.label, variable.unit)
            at = layout.knots[knot, i : i + 1]
            bounds.append(ColumnBound(entry, at, float(given.lower[i]), float(given.upper[i])))
    columns = _columns_by_variable(phase, layout)
    held = columns_beside_rows(phase, layout) if covered else {}
    for row in phase.rows.bounds:
        name = phase.rows.variable_of(row).name
        every = (held if on_coefficients(row, name, covered) else columns)[name]
        _require_point(phase, layout, name, row.where)
        chosen = {Where.START: every[:1], Where.END: every[-1:]}.get(row.where, every)
        bounds.append(ColumnBound(Entry.of(index, row), chosen, row.lower, row.upper))
    return bounds


def _require_point(phase: Phase, layout: PhaseLayout, variable: str, where: Where) -> None:
    """Refuse a bound at an end at which the scheme has no value of the variable."""
    if where not in (Where.START, Where.END) or variable in {state.name for state in phase.dae.states}:
        return
    scheme, at = (layout.runs[0].scheme, 0) if where is Where.START else (layout.runs[-1].scheme, -1)
    is_control = variable in {control.name for control in phase.dae.controls}
    sites = scheme.control_sites if is_control else scheme.nodes
    constant = is_control and len(sites) == 1
    if not constant and sites[at] != (0.0 if where is Where.START else 1.0):
        raise InputError(
            f"Phase {phase.name!r}: {variable!r} is bounded at the {where.value}, but "
            f"{type(scheme).__name__} has no collocation point there; use a Lobatto scheme."
        )


def _columns_by_variable(phase: Phase, layout: PhaseLayout) -> dict[str, NDArray[np.int_]]:
    """Return the columns of every variable of the dynamics, in the order of time."""
    groups = (
        (phase.dae.states, [layout.knots, *(run.states for run in layout.runs)]),
        (phase.dae.algebraic, [run.algebraic for run in layout.runs]),
        (phase.dae.controls, [run.controls for run in layout.runs]),
    )
    found: dict[str, NDArray[np.int_]] = {}
    for variables, parts in groups:
        # Columns are numbered in the order of time; all variables of a group have the same places.
        if variables:
            columns = np.sort(np.concatenate([part.reshape(-1, len(variables)) for part in parts]), axis=0)
            fresh = np.ones(len(columns), dtype=bool)
            fresh[1:] = columns[1:, 0] > columns[:-1, 0]
            found |= {variable.name: columns[fresh, j] for j, variable in enumerate(variables)}
    return found


def _guess(problem: Problem, layouts: Sequence[PhaseLayout], guess: InitialGuess, size: int) -> Array:
    w = np.zeros(size)
    t0 = 0.0
    for i, (phase, layout) in enumerate(zip(problem.phases, layouts, strict=True)):
        known = guess.of(phase, i)
        if layout.t0.column is not None:
            w[layout.t0.column] = t0
        if layout.duration.column is not None:
            w[layout.duration.column] = known.duration
        for scalar, name in zip(layout.parameters, phase.parameter_names, strict=True):
            if scalar.column is not None:
                w[scalar.column] = known.parameters[name]
        _fill(w, phase, layout, with_copies(known, phase.dae), t0)
        t0 += known.duration
    return w


def _fill(w: Array, phase: Phase, layout: PhaseLayout, known: PhaseGuess, t0: float) -> None:
    runs = layout.runs
    # Where rows hold the bounds between the points, the columns of the points have none.
    states, algebraic, controls = (
        phase.rows.limits_of(variables) for variables in (phase.dae.states, phase.dae.algebraic, phase.dae.controls)
    )

    def at(sites: Sequence[Array], inside: float) -> Array:
        """Return the fractions of the phase of the sites, one interval after the other."""
        pairs = zip(runs, sites, strict=True)
        parts = (r.start[:, None] + r.length[:, None] * np.clip(c, inside, 1 - inside) for r, c in pairs)
        return np.concatenate([part.ravel() for part in parts])

    def fill(columns: Sequence[NDArray[np.int_]], values: Array) -> None:
        w[np.concatenate([part.ravel() for part in columns])] = values.ravel()

    nodes, sites = [run.scheme.nodes for run in runs], [run.scheme.control_sites for run in runs]
    w[layout.knots.ravel()] = np.clip(known.states(layout.fractions), *states).ravel()
    fill([run.states for run in runs], np.clip(known.states(at(nodes, 0.0)), *states))
    # Controls and accelerations may jump at knots, where values are those of the interval's own side.
    fill([run.algebraic for run in runs], np.clip(known.algebraic(at(nodes, INSIDE)), *algebraic))
    fill([run.controls for run in runs], np.clip(known.controls(at(sites, INSIDE)), *controls))
    if isinstance(layout.mesh, MovingMesh):
        for interval in layout.intervals:
            w[interval.clock.base.column] = t0 + known.duration * interval.start
            w[interval.clock.span.column] = known.duration * interval.length
