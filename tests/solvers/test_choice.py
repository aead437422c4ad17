"""What plans a problem, and evaluates its functions, where the user does not say."""

from __future__ import annotations

import pytest

import robotraj as rt
from robotraj.solvers.choice import engine_for, solver_for


@pytest.mark.parametrize(
    ("name", "root", "actuated", "solver", "engine"),
    [
        ("ur5", "fixed", None, rt.Fatrop(), rt.Native()),
        ("double_pendulum", "fixed", [], rt.Ipopt(), rt.VirtualMachine()),
        ("solo12", "floating", None, rt.Ipopt(), rt.Native()),
    ],
)
def test_the_robot_decides(name: str, root: str, actuated: list[str] | None, solver: object, engine: object) -> None:
    robot = rt.load(name, root=root) if actuated is None else rt.load(name, root=root, actuated=actuated)
    problem = rt.Problem([rt.Phase(robot, 1.0, limits=None)])
    chosen = solver_for(problem, rt.Mesh(5))
    assert chosen == solver
    assert engine_for(problem, chosen) == engine
