"""A robot that no contact holds falls: its fixed ends must allow it."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import robotraj as rt

G = 9.81


def flight(duration: float | tuple[float, float], speed: float, root: str = "floating", g: float = G) -> rt.Phase:
    """Pose a phase without contacts, whose root rises with a speed and has the opposite one at the end."""
    leg = rt.load("monopod", root=root, gravity=(0, 0, -g))
    q, up = leg.configuration({"root_z": 1.0}), leg.velocity({"root_vz" if root == "floating" else "root_z": speed})
    return rt.Phase(leg, duration, rt.State(q=q, v=up), rt.State(q=q, v=-up), rt.Effort())


@pytest.mark.parametrize("root", ["planar", "floating"])
def test_a_robot_that_stands_without_contacts_is_refused(root: str) -> None:
    """It was planned until the time limit, and the balance of the root named as violated."""
    with pytest.raises(
        rt.InputError, match=r"no contact holds 'monopod'.*\(0, 0, -4\.91\) m/s within 0\.5 s.*contacts="
    ):
        flight(0.5, 0.0, root)


@pytest.mark.parametrize("duration", [0.5, (0.1, 2.0), (0.1, np.inf)])
def test_a_flight_of_the_right_speeds_is_allowed(duration: float | tuple[float, float]) -> None:
    flight(duration, 0.25 * G)


def test_a_flight_of_another_duration_is_refused() -> None:
    with pytest.raises(rt.InputError, match=r"-3\.92\) m/s within 0\.4 s, but the ends give it \(0, 0, -4\.9"):
        flight((0.1, 0.4), 0.25 * G)


def test_without_gravity_the_speed_stays() -> None:
    flight(1.0, 0.0, g=0.0)
    with pytest.raises(rt.InputError, match="no contact holds"):
        flight(1.0, 1.0, g=0.0)


def test_an_end_whose_speed_is_free_is_not_checked() -> None:
    leg = rt.load("monopod", root="floating")
    q = leg.configuration({"root_z": 1.0})
    rt.Phase(leg, 0.3, rt.State(q=q, v=0), rt.State(q=q), rt.Effort())


def test_rest_is_rest_whatever_the_posture() -> None:
    """Ends at rest were not compared with a fall where a position was free; the solver met its iteration limit."""
    leg = rt.load("monopod", root="floating")
    with pytest.raises(rt.InputError, match="no contact holds 'monopod'"):
        rt.Phase(leg, 0.5, rt.State(q=leg.configuration({"root_z": 1.0}), v=0), rt.State(v=0), rt.Effort())


@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_a_foot_that_is_not_on_the_ground_names_the_root_where_it_is_fixed(root: str) -> None:
    dog = rt.load("solo12", root=root)
    with pytest.raises(rt.InputError, match="contact 'FL_FOOT' does not hold") as caught:
        stand = rt.State(q=dog.neutral, v=0)
        rt.plan(rt.Phase(dog, 1.0, stand, stand, rt.Effort(), contacts=[rt.PointContact("FL_FOOT")]), rt.Mesh(4))
    assert ("root='floating'" in str(caught.value)) == (root == "fixed")


@pytest.mark.parametrize("size", [0.1, 100.0])
def test_a_sole_in_millimetres_is_doubted(size: float) -> None:
    robot = rt.load("talos_legs", root="floating")
    foot = rt.FlatFoot("left_sole_link", length=2 * size, width=size)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rt.Phase(robot, 1.0, objective=rt.Effort(), contacts=[foot])
    assert any("100 mm are 0.1 m" in str(each.message) for each in caught) == (size == 100.0)
