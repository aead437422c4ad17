"""A robot of propellers alone hovers, climbs and tilts, with thrusts as controls."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

MOTORS = ((0.2, 0.2), (0.2, -0.2), (-0.2, -0.2), (-0.2, 0.2))


def drone(folder):
    """Return 1 kg with four frames for propellers."""
    parts = [
        '<link name="body"><inertial><mass value="1"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    ]
    for k, (x, y) in enumerate(MOTORS):
        parts.append(
            f'<link name="m{k}"/><joint name="j{k}" type="fixed"><parent link="body"/><child link="m{k}"/>'
            f'<origin xyz="{x} {y} 0"/></joint>'
        )
    path = folder / "drone.urdf"
    path.write_text(f'<robot name="drone">{"".join(parts)}</robot>')
    return rt.load(path, root="floating")


def propellers(most=6.0):
    return [rt.Thruster(f"m{k}", limits=(0.0, most), spin=0.02 * (-1) ** k) for k in range(4)]


def thrusts(point):
    return sum(point.forces[f"m{k}"][i] ** 2 for k in range(4) for i in range(3))


def at(x, z):
    return rt.State(q=[x, 0, z, 0, 0, 0, 1], v=0)


def test_hovering_takes_a_quarter_of_the_weight_from_each_propeller(tmp_path):
    hover = rt.Phase(drone(tmp_path), 1.0, at(0, 1), at(0, 1), rt.Lagrange(thrusts), contacts=propellers())
    solution = rt.plan(hover)
    weight = 9.81
    assert solution.objective == pytest.approx(4 * (weight / 4) ** 2, rel=1e-6)
    np.testing.assert_allclose(solution.at(0.5).forces["m0"], [0.0, 0.0, weight / 4], atol=1e-4)


def test_a_climb_of_least_time_is_that_of_the_sum_of_thrusts(tmp_path):
    """Up with 4 F - m g, then down with m g: T = sqrt(2 L (1/a + 1/b)), since the thrusts may be 0."""
    climb = rt.Phase(drone(tmp_path), (0.1, 5.0), at(0, 0), at(0, 1), rt.Duration(), contacts=propellers(5.0))
    solution = rt.plan(climb)
    assert solution.duration == pytest.approx(np.sqrt(2.0 * (1.0 / (20.0 - 9.81) + 1.0 / 9.81)), rel=1e-3)


def test_a_flight_sideways_tilts_and_is_simulated(tmp_path):
    robot = drone(tmp_path)
    solution = rt.plan(rt.Phase(robot, 1.5, at(0, 1), at(1, 1.5), rt.Lagrange(thrusts), contacts=propellers()))
    assert solution.proof.holds
    report = rt.validate(solution)
    assert report.passed
    # The body leans towards x first, about +y.
    assert solution.at(0.3).q[4] > 0.05
    solution.save(tmp_path / "flight.npz")
    assert rt.load_solution(tmp_path / "flight.npz").problem.phases[0].contacts[0] == propellers()[0]


@pytest.mark.parametrize(
    ("options", "part"),
    [
        ({"direction": (0, 0, 0)}, "direction"),
        ({"limits": (2.0, 1.0)}, "least, greatest"),
        ({"spin": np.inf}, "spin"),
    ],
)
def test_thrusters_that_cannot_be(options, part):
    with pytest.raises(rt.InputError, match=part):
        rt.Thruster("m0", **options)
