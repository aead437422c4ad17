"""Steps with no room for the root are refused before a solve; the bounds and their Jacobian against differences."""

from __future__ import annotations

import time

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.gait.stepping.root_room import RootRoom


@pytest.mark.parametrize("root", ["planar", "floating"])
def test_the_jacobian_of_the_excess_is_that_of_differences(root: str) -> None:
    robot = rt.load("five_link" if root == "planar" else "go2", root=root)
    names = ["root_pitch"] if root == "planar" else ["root_qx", "root_qy", "root_qz"]
    room = RootRoom(robot, (10.0, 11.0), {name: (5.0, 6.0) for name in names}, 0.7)
    rng = np.random.default_rng(3)
    q = pin.integrate(robot.model, rt.gait.stand(robot), 0.3 * rng.standard_normal(robot.nv))
    value, slope = room(q)
    assert value.shape == (1 + len(names),) and slope.shape == (1 + len(names), robot.nv)
    for _ in range(5):
        way = rng.standard_normal(robot.nv)
        ahead, behind = (room(pin.integrate(robot.model, q, h * way))[0] for h in (1e-6, -1e-6))
        np.testing.assert_allclose((ahead - behind) / 2e-6, slope @ way, atol=1e-7)


def test_inside_the_bounds_nothing_is_missed() -> None:
    robot = rt.load("go2", root="floating")
    room = RootRoom(robot, (0.0, 1.0), {"root_qx": (-0.1, 0.1)}, 0.7)
    value, slope = room(rt.gait.stand(robot))
    assert not value.any() and not slope.any()


def test_a_stair_above_the_hips_is_refused_within_two_seconds_with_one_that_would_do() -> None:
    """Both feet reach it, but then the hips are below the upper one; 0.1 m is refused by nobody."""
    robot = rt.load("five_link", root="planar")
    began = time.process_time()
    told = r"its root as high and as level as .* A rise of 0\.\d+ m would do"
    with pytest.raises(rt.InputError, match=told) as refusal:
        rt.gait.stairs(robot, start=0.2, run=0.4, rise=1.2, count=1)
    assert time.process_time() - began < 2.0
    rise = float(str(refusal.value).split("A rise of ")[1].split()[0])
    rt.gait.stairs(robot, start=0.2, run=0.4, rise=rise, count=1)


def test_lower_roots_are_allowed_where_the_bounds_allow_them() -> None:
    robot = rt.load("five_link", root="planar")
    low = rt.gait.Upright(least_height=0.0, tilt=3.0)
    assert rt.gait.stairs(robot, start=0.2, run=0.4, rise=1.2, count=1, upright=low).phases
