"""Plans from closed forms, without transcription and solver."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import unknown_name
from robotraj.problem.constraints.base import Where
from robotraj.solution.feedback.gains import gains_of

INF = np.inf


@dataclass(frozen=True)
class FakeRobot:
    """A robot around a pin.Model of one-axis joints."""

    model: Any
    actuated: tuple[str, ...]
    units: tuple[str, ...]
    damping: Any
    friction: Any
    friction_speed: float = 0.1

    @property
    def velocity_names(self) -> tuple[str, ...]:
        return tuple(self.model.names)[1:]

    @property
    def position_names(self) -> tuple[str, ...]:
        return self.velocity_names

    @property
    def position_units(self) -> tuple[str, ...]:
        return self.units

    @property
    def nv(self) -> int:
        return int(self.model.nv)

    @property
    def actuation(self) -> Any:
        chosen = [self.velocity_names.index(name) for name in self.actuated]
        return np.eye(self.nv)[:, chosen]

    def dissipation(self, v: Any) -> Any:
        return self.damping * v + self.friction * np.tanh(v / self.friction_speed)

    @property
    def springs(self) -> tuple[tuple[str, float, float], ...]:
        return ()

    @property
    def stiffness(self) -> Any:
        return np.zeros(self.nv)

    def resistance(self, q: Any, v: Any) -> Any:
        return self.dissipation(v)

    def spring_energy(self, q: Any) -> float:
        return 0.0

    def frame(self, name: str) -> int:
        if not self.model.existFrame(name):
            raise unknown_name("frame", name, [f.name for f in self.model.frames])
        return int(self.model.getFrameId(name))


def make_robot(
    joints: Sequence[tuple[str, Any]],
    *,
    mass: float = 1.0,
    length: float = 1.0,
    actuated: Sequence[str] | None = None,
    damping: float = 0.0,
    friction: float = 0.0,
    armature: float = 0.0,
    friction_speed: float = 0.1,
) -> FakeRobot:
    """Build a chain of point masses, each hanging ``length`` below its joint; frame ``tip`` at the end."""
    model = pin.Model()
    parent, where = 0, pin.SE3.Identity()
    below = pin.SE3(np.eye(3), np.array([0.0, 0.0, -length]))
    for name, joint in joints:
        parent = model.addJoint(parent, joint, where, name)
        model.appendBodyToJoint(parent, pin.Inertia(mass, np.zeros(3), np.zeros((3, 3))), below)
        where = below
    model.addFrame(pin.Frame("tip", parent, 0, below, pin.FrameType.OP_FRAME))
    model.armature = np.full(model.nv, armature)
    names = tuple(name for name, _ in joints)
    units = tuple("m" if "P" in joint.shortname() else "rad" for _, joint in joints)
    ones = np.ones(model.nv)
    return FakeRobot(model, tuple(actuated or names), units, damping * ones, friction * ones, friction_speed)


@dataclass(frozen=True)
class FakePhase:
    name: str = "phase"
    robot: Any = None
    system: Any = None
    limits: Any = None
    constraints: tuple[Any, ...] = ()
    bound_constraints: tuple[Any, ...] = ()
    bound_contacts: tuple[Any, ...] = ()
    start_bounds: Any = None
    end_bounds: Any = None
    duration_bounds: tuple[float, float] = (0.0, INF)
    parameter_names: tuple[str, ...] = ()
    parameter_bounds: Any = field(default_factory=lambda: SimpleNamespace(lower=(), upper=()))
    body: Any = None
    objective: Any = None
    dae: Any = None
    rows: Any = field(default_factory=lambda: SimpleNamespace(rates=(), limits=dict))

    @property
    def joint_ends(self) -> dict[Where, Any]:
        return {Where.START: self.start_bounds, Where.END: self.end_bounds}


def limits_of(nv: int, **bounds: Any) -> SimpleNamespace:
    """Joint limits, infinite where not given."""
    given = {
        "position_lower": np.full(nv, -INF),
        "position_upper": np.full(nv, INF),
        "velocity": np.full(nv, INF),
        "acceleration": np.full(nv, INF),
        "effort": np.full(nv, INF),
    }
    known = {**given, **{k: np.asarray(v, dtype=float) for k, v in bounds.items()}}

    def sides(quantity: str) -> tuple[Any, Any]:
        if quantity == "position":
            return known["position_lower"], known["position_upper"]
        return -known[quantity], known[quantity]

    return SimpleNamespace(**known, sides=sides)


Curve = Callable[[Any, int], Any]


@dataclass(frozen=True)
class FakePlan:
    """A phase whose curves are polynomials on every interval, fitted to functions of (t, interval)."""

    phase: Any
    knots: Any
    curves: Mapping[str, PiecewisePolynomial]
    parameters: Mapping[str, float] = field(default_factory=dict)

    def at(self, t: Any, interval: int | None = None) -> SimpleNamespace:
        found = {name: curve(t, interval) for name, curve in self.curves.items()}
        if self.phase.robot is not None:
            names = [force.name for contact in self.phase.bound_contacts for force in contact.forces]
            z = {name: found["z"][..., i] for i, name in enumerate(names)}
            return SimpleNamespace(t=t, forces={}, **(found | {"z": z}))
        system = self.phase.system
        named = {
            kind: {v.name: found[kind][..., i] for i, v in enumerate(variables)}
            for kind, variables in (("x", system.states), ("u", system.controls), ("z", system.algebraic))
        }
        return SimpleNamespace(t=t, **named)


@dataclass(frozen=True)
class FakeSolution:
    phases: tuple[FakePlan, ...]
    success: bool = True
    objective: float = 0.0
    proof: Any = None
    problem: Any = field(default_factory=lambda: SimpleNamespace(bound_links=(), links=(), missing=()))

    @property
    def gains(self) -> Any:
        return gains_of(self)


def fit(knots: Any, degree: int, function: Curve) -> PiecewisePolynomial:
    """Interpolate function(t, interval) -> (n,) on every interval by polynomials of that degree."""
    knots = np.asarray(knots, dtype=float)
    sites = lobatto_sites(degree + 1)
    values = [
        np.array([np.atleast_1d(function(t, k)) for t in begin + (end - begin) * sites], dtype=float)
        for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True))
    ]
    return PiecewisePolynomial(knots, [sites] * len(values), values)


def plan(
    phase: Any, knots: Any, degree: int = 10, parameters: Mapping[str, float] | None = None, **curves: Curve
) -> FakePlan:
    """Fit every curve."""
    fitted = {name: fit(knots, degree, curve) for name, curve in curves.items()}
    return FakePlan(phase, np.asarray(knots, dtype=float), fitted, parameters or {})


def robot_plan(robot: FakeRobot, knots: Any, q: Curve, v: Curve, a: Curve, degree: int = 10, **phase: Any) -> FakePlan:
    """Make a plan from closed-form curves, with the torques of inverse dynamics."""
    data = robot.model.createData()

    def tau(t: float, k: int) -> Any:
        now = [np.atleast_1d(curve(t, k)).astype(float) for curve in (q, v, a)]
        return pin.rnea(robot.model, data, *now) + robot.dissipation(now[1])

    return plan(FakePhase(robot=robot, **phase), knots, degree, q=q, v=v, a=a, tau=tau)


@pytest.fixture
def make() -> SimpleNamespace:
    """Builders of robots, phases and plans."""
    return SimpleNamespace(
        robot=make_robot,
        phase=FakePhase,
        plan=plan,
        robot_plan=robot_plan,
        limits=limits_of,
        solution=lambda *phases: FakeSolution(phases),
    )


@pytest.fixture
def two_link() -> FakeRobot:
    """Two links in the vertical plane with damping, friction and armature."""
    return make_robot(
        [("shoulder", pin.JointModelRY()), ("elbow", pin.JointModelRY())],
        damping=0.2,
        friction=0.1,
        armature=0.05,
        friction_speed=1.0,
    )


@pytest.fixture
def swinging(make: SimpleNamespace, two_link: FakeRobot) -> Callable[..., FakePlan]:
    """An exact two-link motion q = (sin 2t, cos 3t) for 1 s on 20 intervals."""

    def build(**phase: Any) -> FakePlan:
        return make.robot_plan(
            two_link,
            np.linspace(0, 1, 21),
            lambda t, k: np.array([np.sin(2 * t), np.cos(3 * t)]),
            lambda t, k: np.array([2 * np.cos(2 * t), -3 * np.sin(3 * t)]),
            lambda t, k: np.array([-4 * np.sin(2 * t), -9 * np.cos(3 * t)]),
            **phase,
        )

    return build
