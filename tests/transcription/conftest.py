"""Small problems that together have every kind of row, variable and cost."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of

HALF = [0, 0.4, 1]


def _pendulum(**more: object) -> rt.System:
    return rt.System(
        ["q", "w"],
        ["u"],
        lambda point: [point.x["w"], point.u["u"] - ca.sin(point.x["q"]) - 0.1 * point.x["w"]],
        **more,
    )


def _effort() -> rt.Lagrange:
    return rt.Lagrange(lambda point: point.u["u"] ** 2 + 0.1 * point.x["w"] ** 4)


def ode() -> tuple[rt.Problem, rt.Mesh]:
    """An ordinary differential equation over a fixed time."""
    phase = rt.Phase(_pendulum(), 2.0, rt.State([0, 0]), rt.State([3, 0]), _effort(), controls={"u": rt.between(-5, 5)})
    return rt.Problem([phase]), rt.Mesh(3)


def free_duration() -> tuple[rt.Problem, rt.Mesh]:
    """The duration is unknown and costs."""
    phase = rt.Phase(_pendulum(), (0.5, 4), rt.State([0, 0]), rt.State([3, 0]), _effort() + 2 * rt.Duration())
    return rt.Problem([phase]), rt.Mesh(3, rt.schemes.Trapezoidal())


def dae() -> tuple[rt.Problem, rt.Mesh]:
    """An algebraic variable, given by a nonlinear equation."""
    system = rt.System(
        ["q", "w"],
        ["u"],
        lambda point: [point.x["w"], point.z["a"]],
        algebraic=["a"],
        residual=lambda point: [point.z["a"] + 0.05 * point.z["a"] ** 3 - point.u["u"] + ca.sin(point.x["q"])],
    )
    phase = rt.Phase(system, (1, 3), rt.State([0, 0]), rt.State([2, 0]), _effort(), algebraic={"a": rt.between(-9, 9)})
    return rt.Problem([phase]), rt.Mesh(3, rt.schemes.FifthDegree())


def parameters() -> tuple[rt.Problem, rt.Mesh]:
    """An unknown and a known parameter in the dynamics, a row and a cost."""
    system = rt.System(
        ["x", "v"],
        ["u"],
        lambda point: [point.x["v"], point.u["u"] / point.p["mass"] - point.p["drag"] * point.x["v"]],
    )
    phase = rt.Phase(
        system,
        1.0,
        rt.State([0, 0]),
        rt.State([1, 0]),
        _mass_cost(),
        [rt.PathConstraint(lambda point: point.x["v"] * point.p["mass"], upper=3, name="momentum", unit="kg m/s")],
        parameters={"mass": rt.between(0.5, 2), "drag": 0.3},
    )
    return rt.Problem([phase]), rt.Mesh(HALF, rt.schemes.RadauIIA(points=2))


def _mass_cost() -> object:
    integral = rt.Lagrange(lambda point: point.u["u"] ** 2 * point.p["mass"])
    return integral + rt.Mayer(lambda start, end: end.p["mass"] ** 2)


def time_dependent() -> tuple[rt.Problem, rt.Mesh]:
    """Dynamics, a row and a cost that depend on time."""
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"] + ca.sin(point.t * point.x["x"])])
    phase = rt.Phase(
        system,
        (0.5, 2),
        rt.State([0]),
        objective=rt.Lagrange(lambda point: (point.x["x"] - point.t**2) ** 2 + point.u["u"] ** 2),
        constraints=[rt.PathConstraint(lambda point: point.x["x"] - ca.exp(point.t), upper=0)],
    )
    return rt.Problem([phase]), rt.Mesh(3, rt.schemes.GaussLegendre(points=2))


def ends() -> tuple[rt.Problem, rt.Mesh]:
    """Rows at one end, a cost of both ends, a free start."""
    energy = rt.PathConstraint(
        lambda point: point.x["w"] ** 2 / 2 - ca.cos(point.x["q"]), lower=0.5, upper=2, name="energy"
    )
    power = rt.PathConstraint(lambda point: point.x["w"] * point.u["u"], upper=1, name="power", unit="W")
    phase = rt.Phase(
        _pendulum(),
        (0.5, 4),
        rt.State({"q": rt.between(-1, 1)}),
        rt.State({"q": 3}),
        _effort() + 3 * rt.Mayer(lambda start, end: (end.x["w"] - start.x["w"]) ** 2 * end.t + start.x["q"] ** 3),
        [rt.AtEnd(energy), rt.AtStart(power), power],
    )
    return rt.Problem([phase]), rt.Mesh(3)


def two_phases() -> tuple[rt.Problem, Sequence[rt.Mesh]]:
    """Two phases of free duration, other meshes and schemes, joined in time and state."""
    clocked = rt.System(
        ["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"] * ca.cos(point.t) - ca.sin(point.x["q"])]
    )
    first = rt.Phase(_pendulum(), (0.2, 2), rt.State([0, 0]), None, _effort(), name="first")
    second = rt.Phase(
        clocked,
        (0.2, 2),
        None,
        rt.State([2, 0]),
        _effort() + rt.Mayer(lambda start, end: end.t**2),
        name="second",
    )
    return rt.Problem([first, second], [rt.Continuity(0, 1)]), [
        rt.Mesh(2),
        rt.Mesh(HALF, rt.schemes.RadauIIA(points=2)),
    ]


def mixed_schemes() -> tuple[rt.Problem, rt.Mesh]:
    """Another scheme on every interval."""
    schemes = [
        rt.HermiteSimpson(),
        rt.schemes.GaussLegendre(points=2),
        rt.schemes.Trapezoidal(),
        rt.schemes.RadauIIA(points=2),
    ]
    phase = rt.Phase(_pendulum(), (1, 3), rt.State([0, 0]), rt.State([3, 0]), _effort())
    return rt.Problem([phase]), rt.Mesh([0, 0.2, 0.5, 0.6, 1], schemes)


def _with_control(control: object, scheme: type) -> Callable[[], tuple[rt.Problem, rt.Mesh]]:
    def problem() -> tuple[rt.Problem, rt.Mesh]:
        made, _ = dae()
        return made, rt.Mesh(3, scheme(control=control))

    return problem


def cartpole() -> tuple[rt.Problem, rt.Mesh]:
    """A robot by inverse dynamics, with a frame kept above the ground."""
    return _cartpole(rt.dynamics.InverseDynamics())


def cartpole_forward() -> tuple[rt.Problem, rt.Mesh]:
    """The same by forward dynamics."""
    return _cartpole(rt.dynamics.ForwardDynamics())


def _cartpole(dynamics: object) -> tuple[rt.Problem, rt.Mesh]:
    phase = rt.Phase(
        rt.load("cartpole"),
        (1.5, 2.5),
        rt.State(q=[0, 0], v=0),
        rt.State(q=[1, np.pi], v=0),
        rt.Effort() + rt.Duration(),
        [
            rt.GroundClearance("tip", -0.6, rt.terrain.Slope(0.1)),
            rt.constraints.JointAcceleration(rt.between(-100, 100)),
            rt.PathConstraint(lambda point: point.tau[0] * point.v[0] + point.momentum[0] + point.com[2], upper=50),
        ],
        dynamics=dynamics,
    )
    return rt.Problem([phase]), rt.Mesh(2)


PROBLEMS = {
    "ode": ode,
    "free duration": free_duration,
    "dae": dae,
    "parameters": parameters,
    "time dependent": time_dependent,
    "ends": ends,
    "two phases": two_phases,
    "mixed schemes": mixed_schemes,
    "linear control": _with_control(rt.schemes.LinearControl(), rt.HermiteSimpson),
    "constant control": _with_control(rt.schemes.ConstantControl(), rt.HermiteSimpson),
    "constant control, Radau": _with_control(rt.schemes.ConstantControl(), rt.schemes.RadauIIA),
    "lecture": lambda: (
        ode()[0],
        rt.Mesh(
            3, rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
        ),
    ),
    "cartpole": cartpole,
    "cartpole, forward": cartpole_forward,
}


@pytest.fixture(params=PROBLEMS)
def nlp(request: pytest.FixtureRequest) -> rt.transcription.Nlp:
    """Every problem in turn, transcribed."""
    return nlp_of(*PROBLEMS[request.param]())


@pytest.fixture
def problems() -> dict[str, Callable[[], tuple[rt.Problem, rt.Mesh]]]:
    """The problems by name."""
    return PROBLEMS
