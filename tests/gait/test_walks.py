"""Gaits as problems, and their plans from the default guess."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait.bounds.swing_clearance import SwingArc
from tests.robots.many_legs import FOUR, SIX, legged


def held(problem: rt.Problem) -> list[list[str]]:
    return [[contact.label for contact in phase.contacts] for phase in problem.phases]


def test_a_walk_is_one_step_onto_its_image(biped: rt.Robot) -> None:
    problem = gait.walk(biped, step_length=0.5, duration=0.7)
    assert [phase.name for phase in problem.phases] == ["single support"]
    assert held(problem) == [["left_foot"]]
    (link,) = problem.links
    assert isinstance(link, rt.Touchdown) and isinstance(link.repeat, rt.Mirror)
    assert link.repeat.displacement == {"q.root_x": 0.5}


def test_the_papers_step_from_the_default_guess(biped: rt.Robot, tmp_path: Path) -> None:
    problem = gait.walk(biped, step_length=0.5, duration=0.7, contact=partial(PointContact, friction=5.0))
    solution = rt.plan(problem, mesh=rt.Mesh(6, rt.HermiteSimpson()))
    assert solution.objective == pytest.approx(469.547244, rel=1e-5)
    assert solution.iterations < 40
    solution.save(tmp_path / "step.npz")
    again = rt.load_solution(tmp_path / "step.npz")
    assert not again.problem.missing
    assert str(again.problem) == str(solution.problem)


def test_two_steps_cost_twice_one(biped: rt.Robot) -> None:
    problem = gait.walk(
        biped, step_length=0.5, duration=0.7, contact=partial(PointContact, friction=5.0), repeat=rt.Periodic()
    )
    solution = rt.plan(problem, mesh=rt.Mesh(6, rt.HermiteSimpson()))
    assert solution.objective == pytest.approx(2 * 469.547244, rel=1e-5)


def test_an_arc_is_as_high_as_asked_halfway() -> None:
    arc = SwingArc(0.1, "foot.x", "step length")
    point = SimpleNamespace(p={"foot.x": 2.0, "step length": 0.5})
    for x, height in ((1.5, -1e-4), (2.0, 0.1), (2.5, -1e-4), (1.75, 0.75 * 0.1001 - 1e-4)):
        assert arc.heights(point, [x, 0.0, 0.0])["swing apex"] == pytest.approx(height, abs=1e-12)


def test_a_walk_can_be_edited(biped: rt.Robot) -> None:
    problem = gait.walk(biped, step_length=0.5, duration=0.7, contact=partial(PointContact, friction=5.0))
    slower = replace(problem, phases=[replace(problem.phases[0], duration=0.8, name="slow step")])
    assert [phase.name for phase in slower.phases] == ["slow step"]
    assert slower.phases[0].duration_bounds == (0.8, 0.8)


def test_speed_length_and_time_are_two_of_three(biped: rt.Robot) -> None:
    by_speed = gait.walk(biped, speed=0.5, duration=0.6)
    assert by_speed.links[0].repeat.displacement == {"q.root_x": pytest.approx(0.3)}
    assert gait.walk(biped, speed=0.5, step_length=0.3).phases[0].duration_bounds == (pytest.approx(0.6),) * 2
    for given in ({}, {"speed": 0.5}, {"speed": 0.5, "duration": 0.6, "step_length": 0.3}):
        with pytest.raises(rt.InputError, match="two of step_length="):
            gait.walk(biped, **given)


def test_double_support_comes_first_and_is_landed_on_at_rest(biped: rt.Robot) -> None:
    problem = gait.walk(biped, step_length=0.3, duration=(0.6, 1.2), double_support=0.25)
    assert [phase.name for phase in problem.phases] == ["double support", "single support"]
    assert held(problem) == [["left_foot", "right_foot"], ["left_foot"]]
    assert [phase.duration_bounds for phase in problem.phases] == [
        (0.15, 0.3),
        (pytest.approx(0.45), pytest.approx(0.9)),
    ]
    assert [type(link) for link in problem.links] == [rt.links.Liftoff, rt.Mirror, rt.links.Linkage]


def test_a_run_has_a_flight(biped: rt.Robot) -> None:
    problem = gait.run(biped, step_length=0.8, duration=0.5, flight=0.4)
    assert [phase.name for phase in problem.phases] == ["stance", "flight"]
    assert isinstance(problem.phases[1], gait.Flight)
    assert [type(link) for link in problem.links] == [rt.links.Liftoff, rt.Touchdown]
    assert sum(phase.duration_bounds[0] for phase in problem.phases) == pytest.approx(0.5)


def test_periodic_writes_both_steps(biped: rt.Robot) -> None:
    problem = gait.walk(biped, step_length=0.3, duration=0.6, repeat=rt.Periodic())
    assert [phase.name for phase in problem.phases] == ["single support", "single support, other side"]
    assert held(problem) == [["left_foot"], ["right_foot"]]
    assert problem.links[-1].repeat.displacement == {"q.root_x": 0.6}


def test_a_trot_stands_on_diagonals(dog: rt.Robot) -> None:
    problem = gait.trot(dog, step_length=0.1, duration=0.25)
    assert held(problem) == [["FL_FOOT", "HR_FOOT"]]
    assert [phase.name for phase in problem.phases] == ["FL_FOOT and HR_FOOT stand"]
    flying = gait.trot(dog, step_length=0.1, duration=0.25, flight=0.2)
    assert held(flying) == [["FL_FOOT", "HR_FOOT"], []]


def test_a_jump_starts_and_ends_standing_still(dog: rt.Robot) -> None:
    problem = gait.jump(dog, length=0.2, height=0.1)
    assert [phase.name for phase in problem.phases] == ["push off", "flight", "landing"]
    assert problem.phases[1].duration_bounds[0] == pytest.approx(np.sqrt(8 * 0.1 / 9.81))
    q = gait.stand(dog)
    np.testing.assert_allclose(problem.phases[0].start_bounds.lower[:19], q)
    np.testing.assert_allclose(problem.phases[2].end_bounds.lower[:19] - q, [0.2, *np.zeros(18)], atol=1e-12)
    assert [type(link) for link in problem.links] == [rt.links.Liftoff, rt.Touchdown]
    stance = 2.5 * np.sqrt(_height(dog, q) / 9.81)
    lengths = [phase.duration_bounds[0] for phase in problem.phases]
    np.testing.assert_allclose([lengths[0], lengths[2]], stance, rtol=0.05)
    assert gait.jump(dog, push=0.2, land=(0.2, 0.4)).phases[2].duration_bounds == (0.2, 0.4)


def test_five_link_jumps_high_by_default() -> None:
    """A stance of 0.3 s, the default before, needs one and a half times its torque."""
    robot = rt.load("five_link", root="planar")
    assert rt.plan(gait.jump(robot, height=0.3), progress=False).proof.holds


def test_planar_robots_land_on_bent_knees() -> None:
    """By effort alone the knees are at 0.002 rad, and round-off decides how many iterations that takes."""
    robot = rt.load("five_link", root="planar")
    jump = gait.jump(robot, height=0.075)
    solution = rt.plan(jump, progress=False)
    landing = solution.phases[2]
    assert solution.proof.holds
    assert min(landing.at(landing.t0).q[[4, 6]]) > 0.3
    assert jump.phases[2].objective == gait.posture_objective(robot, gait.stand(robot))


def test_upright_adds_rows_and_can_be_omitted(dog: rt.Robot) -> None:
    given = gait.trot(dog, step_length=0.1, duration=0.25)
    assert "root height" in str(given)
    assert "root height" not in str(gait.trot(dog, step_length=0.1, duration=0.25, upright=None))
    with pytest.raises(rt.InputError, match="least_height"):
        gait.Upright(least_height=1.2)


def test_contacts_may_be_copied_or_made(biped: rt.Robot) -> None:
    rough = PointContact("left_foot", friction=1.3)
    by_copy = gait.walk(biped, step_length=0.3, duration=0.6, contact=rough)
    assert by_copy.phases[0].contacts[0].friction == 1.3
    with pytest.raises(rt.InputError, match="contact= returned 'left_foot'"):
        gait.walk(biped, step_length=0.3, duration=0.6, contact=lambda frame: frame)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*Implausible effort limit")
def test_a_hexapod_walks_on_tripods_and_both_halves_cost_twice_one(tmp_path: Path) -> None:
    hexapod = legged(tmp_path, SIX)
    half, whole = (
        gait.walk(hexapod, step_length=0.06, duration=0.3, repeat=repeat) for repeat in (None, rt.Periodic())
    )
    assert [set(feet) for feet in held(half)] == [{"FL_foot", "MR_foot", "HL_foot"}]
    assert isinstance(half.links[0].repeat, rt.Mirror)
    plans = [rt.plan(problem) for problem in (half, whole)]
    assert all(plan.proof.holds for plan in plans)
    assert rt.validate(plans[0]).passed
    assert plans[1].objective == pytest.approx(2.0 * plans[0].objective, rel=4e-3)


def test_groups_that_are_no_mirrored_halves_swing_in_turn_through_a_whole_stride(tmp_path: Path) -> None:
    hexapod = legged(tmp_path, SIX)
    pairs = [("ML_foot", "MR_foot"), ("FL_foot", "HR_foot"), ("FR_foot", "HL_foot")]
    problem = gait.walk(hexapod, step_length=0.05, duration=0.3, groups=pairs, double_support=0.25)
    swings = [set(gait.feet_of(hexapod, None)) - set(feet) for feet in held(problem)]
    assert swings == [each for pair in pairs for each in (set(), set(pair))]
    assert problem.links[-1].displacement["q.root_x"] == pytest.approx(3 * 0.05)
    assert isinstance(problem.links[-1], rt.Periodic)
    with pytest.raises(rt.InputError, match="repeat= is a mirror, but the second half of groups="):
        gait.walk(hexapod, step_length=0.05, duration=0.3, groups=pairs, repeat=gait.mirror(hexapod))


def test_a_quadruped_paces_where_both_feet_of_a_side_are_a_group(tmp_path: Path) -> None:
    problem = gait.walk(
        legged(tmp_path, FOUR),
        step_length=0.05,
        duration=0.3,
        groups=[("FL_foot", "HL_foot"), ("FR_foot", "HR_foot")],
    )
    assert held(problem) == [["FR_foot", "HR_foot"]]


def test_robots_that_cannot_fly_or_walk_are_refused(biped: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match=r"needs 2 feet; .*or use rt.gait.trot or rt.gait.crawl, "):
        gait.walk(rt.load("solo12", root="floating"), step_length=0.1, duration=0.2)
    with pytest.raises(rt.InputError, match="needs 4 feet"):
        gait.trot(biped, step_length=0.1, duration=0.2)
    with pytest.raises(rt.InputError, match="fixed in the world"):
        gait.walk(rt.load("five_link"), step_length=0.3, duration=0.6)
    with pytest.raises(rt.InputError, match="has contacts"):
        gait.Flight(biped, 0.3, contacts=[PointContact("left_foot")])
    with pytest.raises(rt.InputError, match="fixed in the world"):
        gait.Flight(rt.load("five_link"), 0.3)
    with pytest.raises(rt.InputError, match="clearance= is -0.1"):
        gait.walk(biped, step_length=0.3, duration=0.6, clearance=-0.1)


def test_a_compass_falls_down_a_slope_without_torque() -> None:
    # Goswami, Thuilot and Espiau, A study of the passive gait of a compass-like biped robot, Int. J. Robotics Research
    # 17 (1998): on 3 degrees steps of 0.535 m in 0.734 s, without any torque.
    robot = rt.load("compass_walker", root="planar")
    slope = rt.terrain.Slope(-float(np.tan(np.radians(3.0))))
    problem = gait.walk(
        robot,
        step_length=0.535,
        duration=(0.5, 1.2),
        clearance=None,
        ground=slope,
        contact=partial(PointContact, friction=2.0),
    )
    drop = 0.535 * np.tan(np.radians(3.0))
    assert problem.links[0].repeat.displacement == {"q.root_x": 0.535, "q.root_z": pytest.approx(-drop)}
    solution = rt.plan(problem, mesh=rt.Mesh(12, rt.HermiteSimpson()))
    assert solution.objective < 0.1
    assert solution.duration == pytest.approx(0.734, abs=0.02)
    gain = solution.at(solution.duration).q - solution.at(0.0).q
    np.testing.assert_allclose(gain[:2], [0.535, -drop], atol=1e-7)


@pytest.mark.slow
def test_five_link_runs() -> None:
    robot = rt.load("five_link", root="planar")
    problem = gait.run(robot, step_length=0.8, duration=0.5, contact=partial(PointContact, friction=1.0))
    solution = rt.plan(problem, mesh=rt.Mesh(10, rt.HermiteSimpson()))
    flight = np.linspace(problem.phases[0].duration_bounds[0] + 1e-6, 0.5, 21)
    assert np.all(solution.at(flight).forces["left_foot"] == 0.0)
    assert solution.iterations < 100


@pytest.mark.slow
def test_solo_trots_from_its_own_guess(dog: rt.Robot) -> None:
    problem = gait.trot(dog, step_length=0.1, duration=0.25, clearance=0.03)
    solution = rt.plan(problem, mesh=rt.Mesh(8, rt.HermiteSimpson()))
    assert solution.iterations < 80
    forces = solution.at(np.linspace(0.0, 0.25, 33)).forces
    for foot in ("FL_FOOT", "HR_FOOT"):
        fx, fy, fz = forces[foot].T
        assert np.all(np.hypot(fx, fy) <= 0.7 * fz + 1e-2)


@pytest.mark.slow
def test_solo_jumps_from_its_own_guess() -> None:
    limits = {"velocity": 30.0, "effort": 6.0, "position": (-2.5, 2.5)}
    robot = rt.load("solo12", root="floating", limits=limits)
    problem = gait.jump(robot, length=0.1, height=0.08, push=0.3, land=0.3)
    solution = rt.plan(problem, mesh=rt.Mesh(5, rt.HermiteSimpson()))
    assert solution.iterations < 120
    air = np.linspace(0.3, solution.duration - 0.3, 41)
    height = [_height(robot, q) for q in solution.at(air).q]
    assert max(height) - 0.5 * (height[0] + height[-1]) == pytest.approx(0.08, abs=2e-3)
    end = solution.at(solution.duration)
    np.testing.assert_allclose(end.q, gait.stand(robot) + [0.1, *np.zeros(18)], atol=1e-7)


def _height(robot: rt.Robot, q: np.ndarray) -> float:
    return float(pin.centerOfMass(robot.model, robot.model.createData(), q)[2])


@pytest.mark.slow
def test_talos_walks_on_flat_feet_from_its_own_guess() -> None:
    robot = rt.load("talos_legs", root="floating")
    sole = partial(FlatFoot, length=0.2, width=0.12)
    problem = gait.walk(robot, step_length=0.2, duration=0.8, double_support=0.2, clearance=0.05, contact=sole)
    solution = rt.plan(problem, mesh=rt.Mesh(6, rt.HermiteSimpson()))
    assert solution.iterations < 60
