"""A slope that is steeper than the friction of all contacts is named."""

from __future__ import annotations

from functools import partial

import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.exclusions.slipping import slipping_contacts


@pytest.fixture(scope="module")
def solo() -> rt.Robot:
    return rt.load("solo12", root="floating")


def trot(robot: rt.Robot, slopes: tuple[float, float], friction: float, **options: object) -> rt.Problem:
    contact = partial(rt.PointContact, friction=friction)
    more = {"margin": 0.0, **options}
    return rt.gait.trot(
        robot, step_length=0.05, duration=0.2, contact=contact, ground=rt.terrain.Slope(*slopes), **more
    )


def test_a_trot_up_a_steep_slope_names_the_friction_that_it_needs(solo: rt.Robot) -> None:
    with pytest.raises(
        rt.NoSolutionFound, match=r"friction cone, .*0.3 must become 0.6 .*slope of the ground"
    ) as found:
        rt.plan(trot(solo, (0.6, 0.0), 0.3), progress=False)
    assert found.value.solution.iterations < 200


@pytest.mark.parametrize(("slopes", "friction", "needed"), [((0.5, 0.0), 0.45, 0.5), ((-0.7, 0.0), 0.6, 0.7)])
def test_the_needed_friction_is_the_steepest_slope(
    solo: rt.Robot, slopes: tuple[float, float], friction: float, needed: float
) -> None:
    (conflict,) = slipping_contacts(trot(solo, slopes, friction))
    assert conflict.needed == pytest.approx(needed) and conflict.bound == friction and conflict.certain


def test_a_margin_needs_more_friction_than_the_slope(solo: rt.Robot) -> None:
    (conflict,) = slipping_contacts(trot(solo, (0.5, 0.0), 0.52, margin=0.1))
    assert conflict.needed == pytest.approx(0.5 / 0.9) and "margin of 10 %" in str(conflict)


def test_gentle_slopes_and_other_grounds_are_not_named(solo: rt.Robot) -> None:
    assert not slipping_contacts(trot(solo, (0.5, 0.0), 0.55))
    ground = rt.terrain.HeightFunction(lambda x, y: 0.6 * x)
    contact = partial(rt.PointContact, friction=0.3)
    hill = rt.gait.trot(solo, step_length=0.05, duration=0.2, contact=contact, ground=ground)
    assert not slipping_contacts(hill)


@pytest.mark.parametrize(("gained", "named"), [({}, True), ({"v.root_x": rt.between(-1.0, 0.0)}, False)])
def test_a_period_that_gains_speed_is_not_named(gained: dict[str, rt.Between], named: bool) -> None:
    robot = rt.load("five_link", root="planar")
    contact = rt.PointContact("left_foot", friction=0.2, ground=rt.terrain.Slope(0.3))
    phase = rt.Phase(robot, 0.5, objective=rt.Effort(), contacts=[contact])
    assert bool(slipping_contacts(rt.Problem([phase], [rt.Periodic(gained)]))) is named


@pytest.mark.parametrize(("root", "needed"), [("planar", 0.3), ("floating", 0.5)])
@pytest.mark.parametrize("end", [0.0, None])
def test_a_robot_at_rest_at_both_ends_stands_all_the_time(root: str, needed: float, end: float | None) -> None:
    robot = rt.load("five_link", root=root)
    contact = rt.PointContact("left_foot", friction=0.2, ground=rt.terrain.Slope(0.3, 0.4))
    start, stop = rt.State(q=None, v=0), rt.State(v=end)
    found = slipping_contacts(rt.Problem([rt.Phase(robot, 0.5, start, stop, rt.Effort(), contacts=[contact])]))
    assert [conflict.needed for conflict in found] == ([] if end is None else [pytest.approx(needed)])
