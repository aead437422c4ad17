"""Kelly's five-link biped: one periodic step from its URDF, with a planar root, a contact, an impact and a mirror.

Values: Kelly, SIAM Review 59 (2017), section 8 and appendix E, and per mesh as recomputed independently of robotraj.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from tests.robots.kelly2017 import five_link_map, five_link_torques

STEP, DURATION = 0.5, 0.7
FIRST = np.array([-0.3, 0.7, 0.0, -0.5, -0.6])
OPTIMUM = np.array([0.08653, 0.49315, -0.12741, -0.34671, -0.35797])
RATES = np.array([-1.5065, -0.6053, 0.0153, -0.5454, -2.0144])
EFFORTS = np.array([24.91, 53.36, 22.68, 16.03])


def standing(robot: rt.Robot, angles: np.ndarray) -> np.ndarray:
    """Configuration of the case's absolute angles, with the left foot at the origin."""
    q = np.concatenate([np.zeros(2), five_link_map("left") @ angles])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    foot = data.oMf[robot.frame("left_foot")].translation
    q[:2] -= foot[[0, 2]]
    return q


def step(robot: rt.Robot, clearance: float = 0.0) -> rt.Problem:
    rising = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], lower=0.0, name="foot rises", unit="m/s")
    falling = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], upper=0.0, name="foot falls", unit="m/s")
    height = rt.GroundClearance("right_foot", rt.constraints.SwingApex(clearance, -STEP, STEP) if clearance else 0.0)
    phase = rt.Phase(
        robot,
        duration=DURATION,
        contacts=[rt.PointContact("left_foot", friction=5.0)],
        parameters={"left_foot.x": 0.0},
        constraints=[height, rt.AtStart(rising), rt.AtEnd(falling)],
        objective=rt.Effort(),
        name="step",
    )
    mirror = rt.Mirror(
        partners={"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"},
        displacement={"q.root_x": STEP},
    )
    return rt.Problem([phase], links=[rt.Touchdown(0, 0, repeat=mirror)])


def guess(robot: rt.Robot) -> rt.guess.Keyframes:
    ends = [rt.State(q=standing(robot, angles)) for angles in (FIRST, FIRST[::-1])]
    return rt.guess.Keyframes([0, 1], ends)


def planned(name: str, mesh: rt.Mesh, clearance: float = 0.0) -> rt.Solution:
    robot = rt.load(name, root="planar")
    return rt.plan(step(robot, clearance), mesh=mesh, guess=guess(robot))


def planned_at_points(name: str, mesh: rt.Mesh) -> rt.Solution:
    """Plan as the paper does: clearance is imposed at the collocation points only."""
    robot = rt.load(name, root="planar")
    limits = rt.interval_limits.ConstraintGeneration(rounds=0)
    return rt.plan(step(robot), mesh, guess(robot), rt.Ipopt(), interval_limits=limits)


@pytest.fixture(scope="module")
def converged() -> rt.Solution:
    return planned("five_link", rt.Mesh(12, rt.schemes.LobattoIIIA(4)))


@pytest.mark.parametrize(
    ("name", "mesh", "value"),
    [
        ("five_link", rt.Mesh(6, rt.HermiteSimpson()), 469.547244),
        ("five_link", rt.Mesh(15, rt.HermiteSimpson()), 469.643326),
        pytest.param("five_link", rt.Mesh(25, rt.HermiteSimpson()), 469.646777, marks=pytest.mark.slow),
        ("five_link", rt.Mesh(9, rt.schemes.Trapezoidal()), 494.713063),
        ("five_link", rt.Mesh(24, rt.schemes.Trapezoidal()), 473.864866),
        ("five_link_table", rt.Mesh(9, rt.schemes.Trapezoidal()), 407.275652),
        ("five_link_table", rt.Mesh(25, rt.HermiteSimpson()), 390.790437),
    ],
    ids=lambda value: str(value) if isinstance(value, str | float) else f"{type(value.scheme).__name__}{value.count}",
)
def test_every_mesh_has_the_papers_value(name: str, mesh: rt.Mesh, value: float) -> None:
    assert planned_at_points(name, mesh).objective == pytest.approx(value, rel=1e-6)


def test_the_converged_step_is_the_papers(converged: rt.Solution) -> None:
    assert converged.objective == pytest.approx(469.6500, rel=2e-5)
    first = converged.at(0.0)
    assert first.q[2:] == pytest.approx(five_link_map("left") @ OPTIMUM, abs=2e-4)
    assert first.v[2:] == pytest.approx(five_link_map("left") @ RATES, abs=4e-3)
    samples = converged.at(np.linspace(0, DURATION, 401))
    efforts = np.abs(five_link_torques(EFFORTS, "left")[3:])
    # The case lists what its coarser mesh had; 25 intervals of Lobatto 4 settle at 25.15, 53.80, 22.68 and 16.16 N m.
    assert np.abs(samples.tau).max(axis=0) == pytest.approx(efforts, rel=1.2e-2)
    robot = converged.phases[0].robot
    assert robot is not None
    data = robot.model.createData()
    heights = []
    for q in samples.q:
        pin.framesForwardKinematics(robot.model, data, q)
        heights.append(data.oMf[robot.frame("right_foot")].translation[2])
    assert max(heights) == pytest.approx(0.07121, abs=2e-4)


def test_the_stance_foot_neither_slides_nor_sinks(converged: rt.Solution) -> None:
    robot = converged.phases[0].robot
    assert robot is not None
    data = robot.model.createData()

    def away(times: np.ndarray) -> float:
        worst = 0.0
        for q in converged.at(times).q:
            pin.framesForwardKinematics(robot.model, data, q)
            worst = max(worst, float(np.abs(data.oMf[robot.frame("left_foot")].translation[[0, 2]]).max()))
        return worst

    assert away(converged.phases[0].points) < 1e-9
    assert away(np.linspace(0, DURATION, 301)) < 1e-4


def test_the_ground_only_pushes_and_the_impact_brings_the_foot_to_rest(converged: rt.Solution) -> None:
    force = converged.at(np.linspace(0, DURATION, 101)).forces["left_foot"]
    assert force[:, 2].min() > 0 and np.abs(force[:, 1]).max() == 0
    (impulse,) = converged.impulses
    assert impulse["impulse.left_foot.z"] > 0
    robot = converged.phases[0].robot
    assert robot is not None
    model, data, first = robot.model, robot.model.createData(), converged.at(0.0)
    swap = [0, 1, 2, 5, 6, 3, 4]
    before = converged.at(DURATION).v[swap]
    pin.computeJointJacobians(model, data, first.q)
    pin.updateFramePlacements(model, data)
    jacobian = pin.getFrameJacobian(model, data, robot.frame("left_foot"), pin.LOCAL_WORLD_ALIGNED)[[0, 2]]
    assert jacobian @ first.v == pytest.approx(0, abs=1e-8)
    momentum = pin.crba(model, data, first.q) @ (first.v - before)
    pushed = jacobian.T @ [impulse["impulse.left_foot.x"], impulse["impulse.left_foot.z"]]
    assert momentum == pytest.approx(pushed, abs=1e-6)


@pytest.mark.slow
def test_lifting_the_foot_costs(converged: rt.Solution) -> None:
    lifted = planned("five_link", rt.Mesh(12, rt.schemes.LobattoIIIA(4)), clearance=0.15)
    assert lifted.objective > converged.objective + 1.0


def test_a_foot_that_slips_needs_friction(converged: rt.Solution) -> None:
    force = converged.at(np.linspace(0, DURATION, 101)).forces["left_foot"]
    used = float((np.abs(force[:, 0]) / force[:, 2]).max())
    assert used > 0.3
    robot = rt.load("five_link", root="planar")
    problem = step(robot)
    slippery = replace(problem.phases[0], contacts=[rt.PointContact("left_foot", friction=0.3)])
    solution = rt.plan(
        replace(problem, phases=[slippery]), mesh=rt.Mesh(12, rt.schemes.LobattoIIIA(4)), guess=guess(robot)
    )
    force = solution.at(solution.phases[0].points).forces["left_foot"]
    assert (np.abs(force[:, 0]) <= 0.3 * force[:, 2] + 1e-6).all()
    assert solution.objective > converged.objective
