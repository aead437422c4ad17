"""The hybrid method: a direct solution starts the boundary value problem of Pontryagin's conditions.

The direct solution determines the arcs, their order and the guess. Collocation of high order and Newton's method solve
the equations. The meshes of the arcs are refined until an independent integration agrees. The result is then checked
for conditions besides the equations: signs of the switching functions, bounds of controls, state constraints.

Sources: von Stryk and Bulirsch, Direct and indirect methods for trajectory
optimization, Annals of Operations Research 37 (1992); Bryson and Ho, Applied Optimal Control (1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, require_solution
from robotraj.indirect.arcs import Arc, affine_controls, control_bounds, find_arcs
from robotraj.indirect.boundary import EndData, boundary_value_problem, end_data, potential
from robotraj.indirect.checks import refuse_active_constraints, violated_conditions
from robotraj.indirect.costate_trajectory import PhaseCostates, costates
from robotraj.indirect.flow import Flow, scales
from robotraj.indirect.newton import NewtonRoot, find_root
from robotraj.indirect.polished import Polished, PolishFailed
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.phase import Phase
from robotraj.solution.solution import Solution
from robotraj.transcription.extract import PhaseTrajectory, extract
from robotraj.transcription.schemes.lobatto import LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import transcribe

POINTS = 7
"""Lobatto points of an interval: order 12."""
MAX_MESHES = 8
"""Largest number of meshes."""
ROOT_TOLERANCE = 1e-10
"""Largest scaled row of a converged root, unless the given tolerance is smaller."""


def polish(solution: Solution, tolerance: float = 1e-9) -> Polished:
    """Solve Pontryagin's boundary value problem from a direct solution.

    Parameters
    ----------
    solution : Solution
        A solution of one phase by a collocation scheme: an ODE, an index-1 DAE or a robot. Supported are bounds on
        controls, fixed or free end states, end constraints on states, and fixed or free duration.
    tolerance : float
        Largest error of an interval against an independent integration, and largest boundary residual,
        relative to 1 + the size of each state.

    Returns
    -------
    Polished
        Arcs, switching times, costates, objective, ``.at(t)``; ``print`` lists the arcs.

    Raises
    ------
    InputError
        The solution has several phases, unknown parameters, active state or path constraints, or singular arcs.
    PolishFailed
        The equations were not solved to the tolerance, or their solution violates a condition of an optimum. Its
        ``.solution`` is the last iterate, whose ``trouble`` is the reason.
    """
    require_solution(solution, "rt.indirect.polish")
    if not tolerance > 0:
        raise InputError(f"polish(tolerance) must be above 0, got {tolerance}.")
    if len(solution.phases) != 1:
        raise InputError(
            f"polish takes a solution of one phase; this one has {len(solution.phases)}. Polish its "
            "phases one by one, with their planned ends fixed."
        )
    known = costates(solution).phases[0]
    phase = known.solution.phase
    for name, low, high in zip(phase.parameter_names, *phase.parameter_bounds, strict=True):
        if low < high:
            raise InputError(f"polish keeps parameters fixed, but {name!r} is unknown; fix it at its planned value.")
    if known.hamiltonian.integrals:
        name = known.hamiltonian.integrals[0].name
        raise InputError(
            f"polish does not support integral constraints such as {name!r}; add a state whose rate is the integrand."
        )
    refuse_active_constraints(known)
    arcs = find_arcs(known)
    parameters = np.array(list(known.solution.parameters.values()), dtype=float)
    equations = Pontryagin(phase, parameters, np.array(control_bounds(phase)))
    knots = known.solution.knots
    x0, xf = (known.solution.trajectory.x(np.array([t]))[0] for t in (knots[0], knots[-1]))
    ends = end_data(equations, x0, xf, known.solution.duration)
    found = _solve(equations, known, arcs, ends, tolerance)
    trouble = found.trouble or "; ".join(violated_conditions(found, affine_controls(known)))
    result = replace(found, trouble=trouble)
    if not result.success:
        raise PolishFailed(f"The plan {phase.name!r} was not polished: {trouble}.\n{result}", result)
    return result


def _solve(
    equations: Pontryagin, known: PhaseCostates, arcs: Sequence[Arc], ends: EndData, tolerance: float
) -> Polished:
    """Solve by Newton's method on meshes that are refined until the independent integration agrees."""
    problem = boundary_value_problem(equations, arcs, ends)
    knots = known.solution.knots
    counts = [max(2, int(np.ceil(np.sum((knots > a.start) & (knots < a.end)) / 3))) for a in arcs]
    meshes = [Mesh(count, LobattoIIIA(POINTS)) for count in counts]
    guess: InitialGuess = FromDirect(equations, known, tuple(arcs), _multipliers(equations, known, ends))
    steps = 0
    for _ in range(MAX_MESHES):
        nlp = transcribe(problem, meshes, guess)
        root = find_root(nlp, min(tolerance, ROOT_TOLERANCE))
        steps += root.steps
        trajectories = extract(nlp, root.w)
        trouble = root.trouble or _negative_duration(trajectories)
        if trouble:
            return _wrap(equations, arcs, trajectories, root, np.inf, steps, tolerance, trouble)
        size = scales(trajectories)
        errors = [
            np.max(np.abs(Flow(equations, arc.sides).defects(part)) / size, axis=1)
            for arc, part in zip(arcs, trajectories, strict=True)
        ]
        worst = max(float(np.max(each)) for each in errors)
        if worst <= tolerance:
            return _wrap(equations, arcs, trajectories, root, worst, steps, tolerance, "")
        meshes = [_refined(mesh, each, tolerance) for mesh, each in zip(meshes, errors, strict=True)]
        guess = FromArcs(trajectories)
    trouble = f"an independent integration still differs by {worst:.1e} after {MAX_MESHES} meshes"
    return _wrap(equations, arcs, trajectories, root, worst, steps, tolerance, trouble)


def _negative_duration(trajectories: Sequence[PhaseTrajectory]) -> str:
    for k, part in enumerate(trajectories):
        if not part.duration > 0:
            return f"arc {k + 1} has the duration {part.duration:.3g} s: the sequence of arcs is not that of an optimum"
    return ""


def _wrap(
    equations: Pontryagin,
    arcs: Sequence[Arc],
    trajectories: Sequence[PhaseTrajectory],
    root: NewtonRoot,
    error: float,
    steps: int,
    tolerance: float,
    trouble: str,
) -> Polished:
    timed = tuple(
        Arc(part.t0, part.t0 + part.duration, arc.sides) for arc, part in zip(arcs, trajectories, strict=True)
    )
    return Polished(equations, timed, tuple(trajectories), root.residual, error, steps, tolerance, trouble)


def _refined(mesh: Mesh, errors: Array, tolerance: float) -> Mesh:
    """Divide intervals whose error is too large, into as many parts as the order of the method requires."""
    pieces = np.ones(mesh.count, dtype=int)
    bad = errors > 0.1 * tolerance
    ratio = np.where(np.isfinite(errors[bad]), errors[bad], 1.0) / (0.1 * tolerance)
    pieces[bad] = np.clip(np.ceil(ratio ** (1.0 / (2 * POINTS - 1))), 2, 4).astype(int)
    knots = [
        np.linspace(a, b, n, endpoint=False) for a, b, n in zip(mesh.knots[:-1], mesh.knots[1:], pieces, strict=True)
    ]
    return Mesh([*np.concatenate(knots), 1.0], mesh.scheme)


def _multipliers(equations: Pontryagin, known: PhaseCostates, ends: EndData) -> Array:
    """Return the end multipliers that fit the direct costates best in the least-squares sense, (n,)."""
    if not ends.constraints:
        return np.zeros(0)
    phi, symbols = potential(equations, ends)
    gradient = ca.vertcat(ca.gradient(phi, symbols["x0"]), ca.gradient(phi, symbols["xf"]))
    function = ca.Function("fit", list(symbols.values()), [gradient, ca.jacobian(gradient, symbols["pi"])])
    x, part = known.solution.trajectory.x, known.solution
    t0, tf = part.t0, part.t0 + part.duration
    value, matrix = function(t0, x(t0), tf, x(tf), np.zeros(len(ends.constraints)))
    wanted = np.concatenate([-known.initial, known.final]) - np.array(value).ravel()
    free = np.isnan(np.concatenate([ends.start, ends.end]))
    return np.asarray(np.linalg.lstsq(np.array(matrix)[free], wanted[free], rcond=None)[0])


class FromDirect(InitialGuess):
    """A guess of states, costates and controls from a direct solution, arc by arc."""

    def __init__(self, equations: Pontryagin, known: PhaseCostates, arcs: tuple[Arc, ...], multipliers: Array) -> None:
        self._equations, self._known, self._arcs, self._multipliers = equations, known, arcs, multipliers

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the direct solution on an arc."""
        arc, equations, known = self._arcs[index], self._equations, self._known
        which = equations.interior(arc.sides)
        dae = bool(equations.phase.dae.algebraic)

        def times(s: Array) -> Array:
            return arc.start + np.asarray(s) * (arc.end - arc.start)

        def states(s: Array) -> Array:
            values = known.evaluate(times(s))
            rest = np.column_stack([values["H"], np.zeros(len(s))])
            return np.hstack([values["x"], values["costate"], rest])

        def algebraic(s: Array) -> Array:
            values = known.evaluate(times(s))
            parts = [values["u"][:, which]] + ([values["z"], values["nu"]] if dae else [])
            return np.hstack(parts)

        multipliers = dict(zip(phase.parameter_names, self._multipliers, strict=False))
        return PhaseGuess(arc.end - arc.start, states, algebraic, lambda s: np.zeros((len(s), 0)), multipliers)


class FromArcs(InitialGuess):
    """A guess from the arcs on an earlier mesh."""

    def __init__(self, trajectories: Sequence[PhaseTrajectory]) -> None:
        self._trajectories = trajectories

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Evaluate the polynomials."""
        part = self._trajectories[index]

        def at(curve: object) -> object:
            return lambda s: curve(part.t0 + np.asarray(s) * part.duration)  # type: ignore[operator]

        return PhaseGuess(part.duration, at(part.x), at(part.z), at(part.u), part.parameters)  # type: ignore[arg-type]
