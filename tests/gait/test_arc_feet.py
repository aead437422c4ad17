"""Walkers with round feet: a passive cycle against Lagrange's equations of the rolling walker, and walks of robots."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt

ROBOTS = Path(__file__).parents[2] / "robots"
GRAVITY, DESCENT = 9.81, 0.01
HIP, LEG, INERTIA, TO_CENTRE, TO_MASS, RADIUS = 1.0, 0.5, 0.02, 1.0, 0.5, 0.2
LEGS = {"left_hip": "right_hip", "left_foot": "right_foot"}


def round_walker(folder: Path) -> rt.Robot:
    """The compass walker with legs of 1.2 m that have a mass, an inertia and round feet."""
    text = (ROBOTS / "compass_walker" / "compass_walker.urdf").read_text()
    text = re.sub(r"<(visual|collision).*?</\1>", "", text, flags=re.DOTALL)
    for old, new in (
        ('mass value="10"', f'mass value="{HIP}"'),
        ('mass value="5"', f'mass value="{LEG}"'),
        ('xyz="0 0 -1"', f'xyz="0 0 {-TO_CENTRE - RADIUS}"'),
        ('ixx="0" iyy="0" izz="0"', f'ixx="0" iyy="{INERTIA}" izz="{INERTIA}"'),
    ):
        assert old in text
        text = text.replace(old, new)
    path = folder / "round_walker.urdf"
    path.write_text(text)
    return rt.load(str(path), root="planar")


def equations() -> tuple[ca.Function, ca.Function]:
    """Accelerations of the leaning angles of both legs, and places and velocities of the three masses, rolling along x.

    The slope's axes are x and y. The walker is written in these two angles alone: its Lagrangian has no contact.
    """
    q, u = ca.SX.sym("q", 2), ca.SX.sym("u", 2)
    hip = ca.vertcat(RADIUS * q[0] + TO_CENTRE * ca.sin(q[0]), RADIUS + TO_CENTRE * ca.cos(q[0]))
    places = [hip, *(hip - TO_MASS * ca.vertcat(ca.sin(q[k]), ca.cos(q[k])) for k in (0, 1))]
    rates = [ca.jtimes(place, q, u) for place in places]
    masses = (HIP, LEG, LEG)
    kinetic = 0.5 * INERTIA * ca.sumsqr(u) + sum(
        0.5 * m * ca.sumsqr(rate) for m, rate in zip(masses, rates, strict=True)
    )
    down = ca.vertcat(np.sin(DESCENT), -np.cos(DESCENT))
    potential = -GRAVITY * sum(m * ca.dot(down, place) for m, place in zip(masses, places, strict=True))
    momentum = ca.gradient(kinetic, u)
    forces = ca.gradient(kinetic - potential, q) - ca.jtimes(momentum, q, u)
    return (
        ca.Function("accelerations", [q, u], [ca.solve(ca.jacobian(momentum, u), forces)]),
        ca.Function("masses", [q, u], [ca.horzcat(*places), ca.horzcat(*rates)]),
    )


def momenta(masses: ca.Function, q: np.ndarray, u: np.ndarray, landing: int) -> np.ndarray:
    """Angular momenta (2,) that an impact keeps: of all about the landing foot, of the other leg about the hip."""
    places, rates = (np.array(each) for each in masses(q, u))
    foot = np.array([places[0, 0] - TO_CENTRE * np.sin(q[landing]), 0.0])

    def about(point: np.ndarray, bodies: list[int]) -> float:
        arms = places[:, bodies] - point[:, None]
        moments = arms[0] * rates[1, bodies] - arms[1] * rates[0, bodies]
        return float(moments @ np.array([HIP, LEG, LEG])[bodies])

    trailing = 1 - landing
    return np.array(
        [
            about(foot, [0, 1, 2]) - INERTIA * u.sum(),
            about(places[:, 0], [1 + trailing]) - INERTIA * u[trailing],
        ]
    )


def test_the_optimum_on_a_slope_is_the_passive_cycle_of_a_rolling_walker(tmp_path: Path) -> None:
    """Without torque, a step of the plan is one of Lagrange's equations, and its impact keeps angular momenta."""
    walker = round_walker(tmp_path)
    ground = rt.terrain.Slope(-np.tan(DESCENT))
    foot = rt.contacts.ArcFoot("left_foot", radius=RADIUS, length=0.4, ground=ground)

    def gap(point: rt.RobotPoint) -> object:
        frame = point.frame("right_foot")
        centre = frame.position + frame.rotation @ np.array([0.0, 0.0, RADIUS])
        return centre[0] * np.sin(DESCENT) + centre[2] * np.cos(DESCENT) - RADIUS

    step = rt.Phase(
        walker,
        (0.6, 1.4),
        rt.State(q={"root_pitch": 0}),
        contacts=[foot],
        parameters={"left_foot.x": 0},
        constraints=[
            rt.PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor"),
            rt.AtEnd(rt.PathConstraint(gap, 0, 0, name="foot on the ground")),
        ],
        objective=rt.Effort(),
    )
    mirror = rt.Mirror(LEGS, displacement={"q.root_x": rt.between(0.3, 0.6), "q.root_z": None})
    mesh = rt.Mesh(10, rt.schemes.LobattoIIIA(4))
    solution = rt.plan(rt.Problem([step], [rt.Touchdown(0, 0, repeat=mirror)]), mesh, tolerance=1e-8)
    assert solution.objective < 1e-10
    first, last = solution.at(0.0), solution.at(solution.duration)
    # A leaning angle is positive forwards along the slope; the root does not turn.
    lean, rate = (np.array([first.q[3], first.q[4]]) - DESCENT, np.array([first.v[3], first.v[4]]))
    assert abs(lean.sum()) < 1e-8
    accelerations, masses = equations()
    run = solve_ivp(
        lambda t, y: [*y[2:], *np.array(accelerations(y[:2], y[2:])).ravel()],
        (0.0, solution.duration),
        [*lean, *rate],
        rtol=1e-10,
        atol=1e-11,
    )
    end = run.y[:, -1]
    np.testing.assert_allclose(end[:2], np.array([last.q[3], last.q[4]]) - DESCENT, atol=1e-7)
    np.testing.assert_allclose(end[2:], [last.v[3], last.v[4]], atol=1e-6)
    np.testing.assert_allclose(end[:2], lean[::-1], atol=1e-7)
    before = momenta(masses, end[:2], end[2:], landing=1)
    # After the impact the legs have changed places: the walker's equations are written for the standing leg first.
    np.testing.assert_allclose(momenta(masses, lean, rate, landing=0), before, atol=1e-6)
    assert rt.validate(solution).passed


def test_the_touching_place_moves_by_the_arc_that_has_rolled() -> None:
    walk = rt.gait.walk(
        rt.load("five_link", root="planar"),
        step_length=0.4,
        duration=0.6,
        contact=partial(rt.contacts.ArcFoot, radius=0.1, length=0.2, friction=0.8),
        clearance=0.02,
    )
    solution = rt.plan(walk)
    assert solution.success
    assert rt.validate(solution).passed
    (foot,) = solution.phases[0].phase.bound_contacts
    robot = solution.phases[0].robot
    first, last = (solution.at(t) for t in (0.0, solution.duration))
    places = [foot.touched(robot, sample.q) for sample in (first, last)]
    moved = places[1] - places[0]
    # The shank leans by its hip, knee and root angles; the arc has rolled by the radius times that.
    leaned = sum(last.q[[2, 3, 4]] - first.q[[2, 3, 4]])
    assert moved[0] == pytest.approx(0.1 * leaned, abs=1e-6)
    assert moved[2] == pytest.approx(0.0, abs=1e-9)
    assert abs(moved[0]) > 0.02
    assert max(share.largest for share in solution.shares if share.kind == "sole") < 0.9 + 1e-6


@pytest.mark.slow
def test_a_humanoid_rolls_over_its_soles_in_space() -> None:
    foot = partial(rt.contacts.ArcFoot, radius=0.4, length=0.2, width=0.12)
    robot = rt.load("talos_legs", root="floating")
    with pytest.warns(UserWarning, match="not symmetric"):
        walk = rt.gait.walk(robot, step_length=0.2, duration=0.7, double_support=0.2, contact=foot, clearance=0.02)
    solution = rt.plan(walk)
    assert solution.success
    assert rt.validate(solution).passed
    assert rt.witness.followed(solution).holds
