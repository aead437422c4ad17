"""Substitutes for solved problems: motions given as formulas, with the interface of Solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.problem.rows import RowTable
from robotraj.robot.load import load


@dataclass
class Phase:
    name: str
    robot: Any = None
    system: Any = None
    constraints: Sequence[Any] = ()
    bound_constraints: Sequence[Any] = ()
    contacts: Sequence[Any] = ()
    bound_contacts: Sequence[Any] = ()

    @property
    def rows(self) -> RowTable:
        bounded = dict.fromkeys(row.variable for each in self.bound_constraints for row in each.rows)
        dae: Any = SimpleNamespace(states=[SimpleNamespace(name=name) for name in bounded], algebraic=(), controls=())
        return RowTable(self.name, dae, dae, (), tuple(self.bound_constraints))


@dataclass
class PhaseSolution:
    phase: Phase
    t0: float
    duration: float
    read: Callable[[np.ndarray], Any] = field(repr=False)
    intervals: int = 20

    @property
    def points(self) -> np.ndarray:
        return self.knots

    @property
    def knots(self) -> np.ndarray:
        return self.t0 + np.linspace(0.0, self.duration, self.intervals + 1)

    def at(self, t: Any, interval: int | None = None) -> Any:
        times = np.atleast_1d(np.asarray(t, dtype=float))
        assert np.all(times >= self.t0 - 1e-9)
        assert np.all(times <= self.t0 + self.duration + 1e-9)
        return self.read(times) if interval is None else self.read(times, interval)


@dataclass
class Plan:
    phases: tuple[PhaseSolution, ...]
    success: bool = True
    status: Any = rt.solvers.Status.SOLVED
    objective: float = 12.345678
    iterations: int = 21
    problem: Any = field(default_factory=lambda: SimpleNamespace(links=()))
    impulses: Sequence[Any] = ()
    message: str = ""
    proof: Any = None
    settings: Any = None
    times: dict[str, float] = field(default_factory=dict)
    refinement: Sequence[Any] = ()
    continuation: Sequence[Any] = ()
    conflicts: Sequence[Any] = ()
    violation_list: Sequence[Any] = ()
    interval_violations: Sequence[Any] = ()
    control_interval_violations: Sequence[Any] = ()
    seconds: float = 0.0
    error: float = np.nan
    claims: Sequence[Any] = ()

    @property
    def duration(self) -> float:
        return sum(p.duration for p in self.phases)


def rows(*limits: tuple[str, float, float], where: Where = Where.THROUGHOUT) -> BoundConstraint:
    """A bound constraint whose rows bound single variables."""
    named = tuple(Row("bound", "", low, high, variable=name) for name, low, high in limits)
    return BoundConstraint("bounds", named, lambda point: [], where)


def _limits(robot: Any) -> list[tuple[str, float, float]]:
    limits, found = robot.limits, []
    for i, joint in enumerate(robot.joint_names):
        found.append((f"q.{joint}", limits.position_lower[i], limits.position_upper[i]))
        found.append((f"v.{joint}", -limits.velocity[i], limits.velocity[i]))
        found.append((f"tau.{joint}", -limits.effort[i], limits.effort[i]))
    return found


def make_plan(
    robot: Any,
    duration: float = 5.0,
    phases: int = 1,
    *,
    start: float = 0.0,
    seed: int = 0,
    amplitude: float = 0.7,
    constraints: Sequence[Any] = (),
) -> Plan:
    """q = q0 + amplitude sin(w t + phase) for each joint, cut into phases of equal length."""
    rng = np.random.default_rng(seed)
    w = 2.0 * np.pi * rng.uniform(0.15, 0.35, robot.nq)
    shift = rng.uniform(0.0, 2.0 * np.pi, robot.nq)

    def read(t: np.ndarray, interval: int | None = None) -> Any:
        angle = w * t[:, None] + shift
        tau = 20.0 * np.sin(angle + 0.4)[:, : robot.nu]
        return SimpleNamespace(
            t=t, q=robot.neutral + amplitude * np.sin(angle), v=amplitude * w * np.cos(angle), tau=tau
        )

    each, results = duration / phases, []
    for k in range(phases):
        phase = Phase(f"wave {k + 1}", robot, None, constraints, (rows(*_limits(robot)),))
        results.append(PhaseSolution(phase, start + k * each, each, read))
    return Plan(tuple(results))


@pytest.fixture(scope="session")
def wave_plan() -> Callable[..., Plan]:
    return make_plan


@pytest.fixture(scope="session")
def make_rows() -> Callable[..., Any]:
    return rows


@pytest.fixture
def block_plan() -> Plan:
    """Bang-bang double integrator, x from 0 to 1 in 2 s, as a system; u jumps at the middle knot."""
    variable = lambda name, unit: SimpleNamespace(name=name, unit=unit)  # noqa: E731
    system = SimpleNamespace(
        name="block",
        states=(variable("x", "m"), variable("v", "m/s")),
        controls=(variable("u", "N"),),
        algebraic=(),
    )

    def read(t: np.ndarray, interval: int | None = None) -> Any:
        late = t > 1.0 if interval is None else np.full(len(t), interval >= 1)
        x = np.where(late, 1.0 - (2.0 - t) ** 2 / 2.0, t**2 / 2.0)
        state = {"x": x, "v": np.where(late, 2.0 - t, t)}
        return SimpleNamespace(t=t, x=state, u={"u": np.where(late, -1.0, 1.0)}, z={}, q=None)

    bounds = (
        rows(("u", -1.0, 1.0), ("v", -np.inf, 3.0)),
        rows(("x", 1.0, 1.0), where=Where.END),
        rows(("u", -2.0, 0.9)),
    )
    return Plan((PhaseSolution(Phase("move", None, system, (), bounds), 0.0, 2.0, read, intervals=2),))


@pytest.fixture(scope="session")
def ur5() -> Any:
    return load("ur5")


@pytest.fixture(scope="session")
def talos() -> Any:
    return load("talos")


@pytest.fixture(scope="session")
def double_pendulum() -> Any:
    return load("double_pendulum")


@pytest.fixture(scope="session")
def walk() -> Any:
    """Half a gait of the five-link biped, its swing foot raised; left and right change places at its heel strike."""
    robot = load("five_link", root="planar")
    swing = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], lower=0, name="swing foot up")
    landing = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], upper=0, name="swing foot down")
    raised = rt.GroundClearance("right_foot", rt.constraints.SwingApex(0.03, -0.5, 0.5))
    phase = rt.Phase(
        robot,
        duration=0.7,
        contacts=[rt.PointContact("left_foot", friction=5.0)],
        objective=rt.Effort(),
        constraints=[raised, rt.AtStart(swing), rt.AtEnd(landing)],
        parameters={"left_foot.x": 0.0},
        name="step",
    )
    pairs = {"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"}
    mirror = rt.Mirror(partners=pairs, displacement={"q.root_x": 0.5})
    joints = {"root_z": 0.8, "root_pitch": 0.1, "left_knee": 0.3, "right_knee": 0.3}
    ends = [
        rt.State(q=robot.configuration(joints | {"root_x": x, "left_hip": left, "right_hip": right}))
        for x, left, right in ((-0.25, -0.4, 0.2), (0.25, 0.2, -0.4))
    ]
    problem = rt.Problem([phase], links=[rt.Touchdown(0, 0, repeat=mirror)])
    mesh = rt.Mesh(6, rt.HermiteSimpson())
    solution = rt.plan(problem, mesh=mesh, guess=rt.guess.Keyframes([0, 1], ends), check=False)
    assert solution.success
    return solution
