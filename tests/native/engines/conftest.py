from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.schemes.mesh import Mesh


@pytest.fixture
def engine(tmp_path: Path) -> rt.engines.Compiled:
    """Compiles functions of any size, into a separate cache."""
    return rt.engines.Compiled(least=1, cache=tmp_path / "cache")


def cartpole() -> tuple[rt.Problem, Mesh]:
    phase = rt.Phase(rt.load("cartpole"), (1.0, 3.0), rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0), rt.Effort())
    return rt.Problem([phase]), rt.Mesh(5)


def block() -> tuple[rt.Problem, Mesh]:
    """A DAE with a parameter, a path constraint and functions that no processor adds in one instruction."""
    system = rt.System(
        ["x", "v"],
        ["u"],
        lambda point: [ca.tanh(point.x["v"]), point.z["lam"] - ca.fmax(0.1, point.p["drag"]) * ca.fabs(point.x["v"])],
        algebraic=["lam"],
        residual=lambda point: [ca.exp(point.z["lam"]) - 1 - ca.sqrt(2 + ca.sin(point.x["x"])) * point.u["u"]],
    )
    phase = rt.Phase(
        system,
        (0.1, 9.0),
        rt.State([0, 0]),
        rt.State([1, 0]),
        rt.Lagrange(lambda point: point.u["u"] ** 2 + ca.if_else(point.x["x"] > 0.5, point.x["v"] ** 3, 0)),
        constraints=[rt.PathConstraint(lambda point: ca.atan2(point.x["v"], 2 + point.x["x"] ** 2), upper=3)],
        parameters={"drag": rt.between(0.2, 0.3)},
    )
    return rt.Problem([phase]), rt.Mesh(4, rt.schemes.RadauIIA(3))


def standing() -> tuple[rt.Problem, Mesh]:
    """A robot with a moving root, a quaternion and a contact."""
    robot = rt.load("hopper", root="floating")
    contacts = [rt.PointContact("foot")]
    phase = rt.Phase(robot, 0.3, rt.State(v=0), objective=rt.Effort(), contacts=contacts)
    return rt.Problem([phase]), rt.Mesh(2)


PROBLEMS: dict[str, Callable[[], tuple[rt.Problem, Mesh]]] = {"cartpole": cartpole, "block": block}


@pytest.fixture(params=PROBLEMS)
def posed(request: pytest.FixtureRequest) -> tuple[rt.Problem, Mesh]:
    return PROBLEMS[request.param]()


@pytest.fixture
def swing_up() -> tuple[rt.Problem, Mesh]:
    return cartpole()


@pytest.fixture
def stance() -> tuple[rt.Problem, Mesh]:
    return standing()


@pytest.fixture(name="polynomial")
def small_function() -> ca.Function:
    """An SX function that compiles quickly."""
    x, y = ca.SX.sym("x", 3), ca.SX.sym("y", 2)
    return ca.Function("polynomial", [x, y], [ca.vertcat(x[0] * y[1] + x[2], ca.dot(x, x) - 2.5 * y[0])])
