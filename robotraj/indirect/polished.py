"""The result of ``polish``: the extremal on its arcs."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError, RobotrajError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Named
from robotraj.indirect.arcs import Arc, Side
from robotraj.indirect.flow import Flow
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.problem.problem import Problem
from robotraj.robot.tangent import normalised
from robotraj.solution.errors import NoSolutionFound
from robotraj.solution.sample import Times
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.lobatto import LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh


class PolishFailed(NoSolutionFound):
    """Pontryagin's conditions were not solved; ``solution`` is the last iterate, a ``Polished``."""

    solution: Polished  # type: ignore[assignment]

    def __init__(self, message: str, solution: Polished) -> None:
        RobotrajError.__init__(self, message)
        self.solution = solution


@dataclass(frozen=True, eq=False)
class PolishedSample(OneLine):
    """Values at a time (floats) or at m times (arrays (m,)).

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    x, u : Named
        States and controls by name.
    costate : Named
        lambda = dJ/dx by state name.
    hamiltonian : float or ndarray (m,)
        H = l + lambda' f [objective / s].
    q, v, tau : ndarray or None
        Joint positions, velocities and torques of a robot, (n,) or (m, n).
    """

    t: float | Array
    x: Named[float | Array]
    u: Named[float | Array]
    costate: Named[float | Array]
    hamiltonian: float | Array
    q: Array | None = None
    v: Array | None = None
    tau: Array | None = None


@dataclass(frozen=True, eq=False)
class Polished(OneLine):
    """A solution of Pontryagin's boundary value problem.

    Attributes
    ----------
    equations : Pontryagin
    arcs : tuple of Arc
        Times and sides of the controls.
    trajectories : tuple of PhaseTrajectory
        States, costates, Hamiltonian and cost as polynomials, one entry per arc.
    residual : float
        Largest scaled residual of the discretised boundary value problem.
    error : float
        Largest difference, at and between knots, to an independent integration of every interval (DOP853, 1e-12),
        relative to 1 + the size of the state.
    steps : int
        Newton steps on all meshes.
    tolerance : float
    trouble : str
        Reason of a failure; empty for a solution.
    """

    equations: Pontryagin
    arcs: tuple[Arc, ...]
    trajectories: tuple[PhaseTrajectory, ...]
    residual: float
    error: float
    steps: int
    tolerance: float
    trouble: str = ""

    @property
    def success(self) -> bool:
        """Whether the equations hold to the tolerance and all other checks passed."""
        return not self.trouble and self.residual <= self.tolerance and self.error <= self.tolerance

    @property
    def objective(self) -> float:
        """The objective: integral and end costs."""
        equations = self.equations
        first, last = self.trajectories[0], self.trajectories[-1]
        t0, tf = first.t0, last.t0 + last.duration
        nx = equations.nx
        y0, yf = first.x(t0, 0), last.x(tf)
        return float(yf[-1]) + equations.end_cost(t0, y0[:nx], tf, yf[:nx])

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        last = self.trajectories[-1]
        return last.t0 + last.duration - self.trajectories[0].t0

    @property
    def switching_times(self) -> dict[str, tuple[float, ...]]:
        """Times at which each control changes sides [s], by control."""
        found: dict[str, list[float]] = {control.name: [] for control in self.equations.phase.dae.controls}
        for before, after in zip(self.arcs[:-1], self.arcs[1:], strict=True):
            for name, a, b in zip(found, before.sides, after.sides, strict=True):
                if a is not b:
                    found[name].append(after.start)
        return {name: tuple(times) for name, times in found.items()}

    @property
    def knots(self) -> Array:
        """Times of the knots of all arcs [s]."""
        return np.unique(np.concatenate([part.x.breaks for part in self.trajectories]))

    def at(self, t: Times) -> PolishedSample:
        """Evaluate at times [s]; at a switching time, on the later arc.

        Raises
        ------
        InputError
            A time outside the motion.
        """
        times = np.atleast_1d(np.asarray(t, dtype=float))
        first, last = self.arcs[0].start, self.arcs[-1].end
        slack = 1e-9 * max(1.0, last - first)
        if times.ndim > 1 or not np.all((times >= first - slack) & (times <= last + slack)):
            raise InputError(
                f"The time t = {t} is outside the polished motion; give times from {first:g} s to {last:g} s."
            )
        starts = np.array([arc.start for arc in self.arcs])
        owner = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(starts) - 1)
        nx, dae = self.equations.nx, self.equations.phase.dae
        y, u = np.empty((len(times), 2 * nx + 2)), np.empty((len(times), len(dae.controls)))
        for k in np.unique(owner):
            chosen = owner == k
            y[chosen], u[chosen] = self.on_arc(int(k), times[chosen])
        if np.ndim(t) == 0:
            y, u = y[0], u[0]
        names = [s.name for s in dae.states]
        x: Named[float | Array] = Named("state", names, y[..., :nx].T)
        costate: Named[float | Array] = Named("state", names, y[..., nx : 2 * nx].T)
        controls: Named[float | Array] = Named("control", [c.name for c in dae.controls], u.T)
        given = times if np.ndim(t) else float(times[0])
        robot = self.equations.phase.robot
        if robot is None:
            return PolishedSample(given, x, controls, costate, y[..., 2 * nx])
        end = robot.nq + robot.nv
        motion = normalised(robot.model, y[..., : robot.nq]), y[..., robot.nq : end], u[..., : robot.nu]
        return PolishedSample(given, x, controls, costate, y[..., 2 * nx], *motion)

    @cached_property
    def _flows(self) -> list[Flow]:
        return [Flow(self.equations, arc.sides) for arc in self.arcs]

    def on_arc(self, k: int, times: Array) -> tuple[Array, Array]:
        """Return states (m, 2 nx + 2) and controls (m, nu) of arc k at times."""
        part = self.trajectories[k]
        y = part.x(times)
        # Between the nodes H_u = 0 determines controls more accurately than a polynomial through the nodes.
        interior = self._flows[k].algebraic(times, y, part.z(times)).T
        values = self.equations.controls(self.arcs[k].sides, interior)
        return y, np.array([np.broadcast_to(v, times.shape) for v in values]).reshape(-1, len(times)).T

    def solution(self) -> Solution:
        """Return the motion as a Solution of one phase: to save, plot, replay, validate or start from.

        Between the knots its controls are polynomials through their exact values at the collocation points.
        """
        from robotraj.solution.phase_solution import PhaseSolution
        from robotraj.solution.solution import Solution

        equations, parts = self.equations, self.trajectories
        nx, nz = equations.nx, len(equations.phase.dae.algebraic)
        x, z, u, sites, times = [], [], [], [], []
        for k, part in enumerate(parts):
            free = len(equations.interior(self.arcs[k].sides))
            ends = zip(part.x.breaks[:-1], part.x.breaks[1:], strict=True)
            for values, inner, nodes, (a, b) in zip(part.x.values, part.z.values, part.z.sites, ends, strict=True):
                at = a + (b - a) * nodes
                x.append(values[:, :nx])
                z.append(inner[:, free : free + nz])
                u.append(self.on_arc(k, np.clip(at, a, b))[1])
                sites.append(nodes)
                times.append(at)
        breaks = np.concatenate([*(part.x.breaks[:-1] for part in parts), parts[-1].x.breaks[-1:]])
        state_sites = [s for part in parts for s in part.x.sites]
        motion, inner_values, controls = (
            PiecewisePolynomial(breaks, s, values) for s, values in ((state_sites, x), (sites, z), (sites, u))
        )
        parameters = dict(zip(equations.phase.parameter_names, equations.parameters.tolist(), strict=True))
        points = np.unique(np.concatenate(times))
        trajectory = PhaseTrajectory(
            float(breaks[0]), self.duration, motion, inner_values, controls, points, parameters
        )
        fractions = (breaks - breaks[0]) / self.duration
        mesh = Mesh([0.0, *fractions[1:-1], 1.0], LobattoIIIA(len(sites[0])))
        return Solution(
            Problem([equations.phase]),
            (PhaseSolution(equations.phase, mesh, trajectory),),
            Status.SOLVED if self.success else Status.STALLED,
            self.trouble or "Pontryagin's equations solved",
            self.objective,
            self.steps,
            {},
        )

    def __str__(self) -> str:
        state = "polished" if self.success else f"not polished: {self.trouble}"
        lines = [
            f"{state}: objective {self.objective:.12g}, duration {self.duration:.12g} s, "
            f"{len(self.arcs)} arcs, residual {self.residual:.1e}, integration error {self.error:.1e}, "
            f"{self.steps} Newton steps"
        ]
        names = [control.name for control in self.equations.phase.dae.controls]
        for arc in self.arcs:
            sides = ", ".join(f"{n} {_describe(side)}" for n, side in zip(names, arc.sides, strict=True))
            lines.append(f"  {arc.start:.10f} to {arc.end:.10f} s: {sides}")
        return "\n".join(lines)


def _describe(side: Side) -> str:
    return "interior" if side is Side.INTERIOR else f"at its {side.value}"
