"""Costates of a solution: callable values in time, named by states.

lambda = dJ/dx, the derivative of the least remaining cost with respect to the state. J is minimised,
H = l + lambda' f and dlambda/dt = -dH/dx.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, require_solution
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Named
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.costates.hamiltonian import Hamiltonian
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.sample import Times
from robotraj.solution.solution import Solution
from robotraj.transcription.collocation.index_reduction import path_equalities


@dataclass(frozen=True, eq=False)
class CostateSample(OneLine):
    """Duals at a time (floats) or at m times (arrays (m,)).

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    x : Named
        Costates by state [objective / state unit].
    z : Named
        Multipliers nu of the algebraic rows by row [objective / (s row unit)].
    path : Named
        Densities eta of path rows [objective / (s row unit)], then multipliers of integral rows [objective / row unit];
        positive at an upper bound.
    hamiltonian : float or ndarray (m,)
        H = l + lambda' f + nu' g along the trajectory, integral rows with their multipliers included [objective / s].
    """

    t: float | Array
    x: Named[float | Array]
    z: Named[float | Array]
    path: Named[float | Array]
    hamiltonian: float | Array


@dataclass(frozen=True, eq=False)
class PhaseCostates(OneLine):
    """Duals of one phase of a solution.

    Attributes
    ----------
    solution : PhaseSolution
    duals : PhaseDuals
        The piecewise polynomials.
    """

    solution: PhaseSolution
    duals: PhaseDuals

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """The phase's Hamiltonian as a function of its arguments."""
        return Hamiltonian.of(self.solution.phase)

    @property
    def initial(self) -> Array:
        """Lambda at the start of the phase, (nx,): the sensitivity of the objective to the start state."""
        return np.array(self.duals.costate.values[0][0])

    @property
    def final(self) -> Array:
        """Lambda at the end of the phase, (nx,)."""
        return np.array(self.duals.costate.values[-1][-1])

    def evaluate(self, t: Array, interval: int | None = None) -> dict[str, Array]:
        """Evaluate the Hamiltonian, its arguments and derivatives, and bounds' densities at times (m,)."""
        t = np.asarray(t, dtype=float)
        curves, duals = self.solution.trajectory, self.duals
        known = {
            "t": t,
            "x": curves.x(t, interval),
            "z": curves.z(t, interval),
            "u": curves.u(t, interval),
            "p": np.tile(list(curves.parameters.values()), (len(t), 1)),
            "costate": self._costate(t, interval),
            "nu": duals.residual(t, interval),
            "eta": duals.path(t, interval),
        }
        # The row of an integral in the NLP is the duration times an average.
        known["eta"][:, len(self.hamiltonian.path) :] *= self.solution.duration
        more = {name: getattr(duals, name)(t, interval) for name in ("states", "algebraic", "controls")}
        return known | more | self.hamiltonian(**known)

    def _costate(self, t: Array, interval: int | None) -> Array:
        """Return lambda from the side of the interval, since it may jump at a knot."""
        if interval is None:
            return self.duals.costate(t)
        knots = self.solution.knots
        nudge = 1e-9 * (knots[interval + 1] - knots[interval])
        return self.duals.costate(np.clip(t, knots[interval] + nudge, knots[interval + 1] - nudge))

    def at(self, t: Times) -> CostateSample:
        """Evaluate at global times within the phase [s]; at a jump, the value after it."""
        first, last = self.solution.t0, self.solution.t0 + self.solution.duration
        times = np.asarray(t, dtype=float)
        slack = 1e-9 * max(1.0, last - first)
        if times.ndim > 1 or not np.all((times >= first - slack) & (times <= last + slack)):
            raise InputError(f"Costates are known from {first:g} s to {last:g} s; got t = {t}.")
        values = self.evaluate(np.atleast_1d(times))
        if times.ndim == 0:
            values = {name: array[0] for name, array in values.items()}
        dae, rows = self.hamiltonian.dae, [*self.hamiltonian.path, *self.hamiltonian.integrals]
        return CostateSample(
            times if times.ndim else float(times),
            Named("state", [s.name for s in dae.states], values["costate"].T),
            Named("algebraic row", [r.name for r in dae.residuals], values["nu"].T),
            Named("path row", [row.label for row in rows], values["eta"].T),
            values["H"],
        )


@dataclass(frozen=True, eq=False)
class Costates(OneLine):
    """Duals of all phases of a solution."""

    phases: tuple[PhaseCostates, ...]

    def at(self, t: Times) -> CostateSample:
        """Evaluate at a global time, or at times of one phase; where phases meet, the later one is evaluated."""
        starts = np.array([part.solution.t0 for part in self.phases])
        owner = np.clip(np.searchsorted(starts, np.asarray(t, dtype=float), side="right") - 1, 0, len(starts) - 1)
        if len(np.unique(owner)) > 1:
            raise InputError("The times lie in several phases; use costates.phases[i].at(t) for each.")
        return self.phases[int(np.atleast_1d(owner)[0])].at(t)


def costates(solution: Solution) -> Costates:
    """Return the costates of a solution, from the multipliers of its NLP by covector mapping.

    Parameters
    ----------
    solution : Solution
        A solution of ``rt.plan`` by any scheme: fixed or free duration, ODE or DAE.

    Returns
    -------
    Costates
        ``.at(t).x["v"]``, ``.at(t).hamiltonian``, ``.phases[0].initial``.

    Raises
    ------
    InputError
        The solver did not converge, or a phase has contacts, a quaternion or an equality constraint on its state.

    Notes
    -----
    Sign: lambda = dJ/dx of the minimised objective J. The order of convergence at the knots depends on the scheme; see
    ``robotraj.solution.costates.covector``.
    """
    require_solution(solution, "rt.indirect.costates")
    held = [phase.name for phase in solution.problem.phases if phase.dae.invariants]
    if held:
        raise InputError(
            f"Phase {held[0]!r} has contacts or the quaternion of a floating root as invariants: its costates are not "
            "unique. Use costates for phases without invariants."
        )
    for phase in solution.problem.phases:
        for equation in path_equalities(phase)[:1]:
            row = phase.rows.path[equation.row]
            raise InputError(
                f"Phase {phase.name!r} has an equality constraint on its state, {row.label!r}, at all times: its "
                "costates are not unique. Use costates for phases without one."
            )
    if not solution.duals:
        raise InputError(
            "This solution has no costates: the solver did not converge. Plan again until solution.success holds."
        )
    return Costates(tuple(PhaseCostates(p, d) for p, d in zip(solution.phases, solution.duals, strict=True)))
