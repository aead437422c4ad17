"""Contacts in replays: forces at their points, cones at the feet, impulses, required heights, mirrored periods."""

import base64
import gzip
import json
import re
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.replay_page.clearance import clearance_scene
from robotraj.replay_page.contacts import contact_scene, held, weight_of
from robotraj.replay_page.footholds import Foothold, contact_frames
from robotraj.replay_page.write import replay
from robotraj.solution.cycles.gait_cycles import gait_cycles


def data_of(path) -> dict:
    (packed,) = re.findall(r'id="data">([^<]*)<', path.read_text())
    return json.loads(gzip.decompress(base64.b64decode(packed)))["runs"][0]


def test_forces_act_at_the_foot_that_stands(walk):
    robot, course = walk.phases[0].phase.robot, gait_cycles(walk, 2)
    scene = contact_scene(course, robot, 1.2)
    assert scene["names"] == ["left_foot", "right_foot"]
    assert scene["unit"] == pytest.approx(40.0 * 9.81)
    assert scene["length"] == pytest.approx(0.4)
    first, second = scene["forces"]
    assert (first["foot"], second["foot"]) == (0, 1)
    for track, cycle_phase, foot in ((first, course.phases[0], "left_foot"), (second, course.phases[1], "right_foot")):
        t, p, f = np.array(track["t"]), np.reshape(track["p"], (-1, 3)), np.reshape(track["f"], (-1, 3))
        assert (t[0], t[-1]) == pytest.approx((cycle_phase.t0, cycle_phase.t0 + 0.7))
        for k in (0, len(t) // 3, len(t) - 1):
            data = robot.model.createData()
            pin.framesForwardKinematics(robot.model, data, cycle_phase.at(t[k]).q)
            np.testing.assert_allclose(p[k], data.oMf[robot.frame(foot)].translation, atol=1e-4)
        inside = slice(3, 8)
        np.testing.assert_allclose(f[inside], cycle_phase.at(t[inside]).forces[foot], rtol=1e-3, atol=1e-2)


def test_cones_stand_at_the_footholds_while_they_are_held(walk):
    cones = contact_scene(gait_cycles(walk, 3), walk.phases[0].phase.robot, 1.2)["cones"]
    assert [cone["foot"] for cone in cones] == [0, 1, 0]
    np.testing.assert_allclose(
        [cone["apex"] for cone in cones], [[0, 0.08, 0], [0.5, -0.08, 0], [1, 0.08, 0]], atol=1e-6
    )
    assert all(cone["normal"] == [0, 0, 1] and cone["sole"] == [] for cone in cones)
    assert np.tan(cones[0]["angle"]) == pytest.approx(5.0)
    np.testing.assert_allclose([(cone["start"], cone["end"]) for cone in cones], [(0, 0.7), (0.7, 1.4), (1.4, 2.1)])


def test_impulses_are_marked_where_and_when_the_foot_comes_down(walk):
    impacts = contact_scene(gait_cycles(walk, 2), walk.phases[0].phase.robot, 1.2)["impacts"]
    assert [(impact["foot"], impact["t"]) for impact in impacts] == [(1, 0.7), (0, 1.4)]
    np.testing.assert_allclose([impact["p"] for impact in impacts], [[0.5, -0.08, 0.0], [1.0, 0.08, 0.0]], atol=1e-6)
    (impulses,) = walk.impulses
    expected = [impulses["impulse.left_foot.x"], 0.0, impulses["impulse.left_foot.z"]]
    np.testing.assert_allclose(impacts[0]["impulse"], expected, rtol=1e-4)


def test_bars_say_which_contact_is_held(walk):
    assert held(gait_cycles(walk, 3)) == [
        {"label": "left_foot", "spans": [[0.0, 0.7], pytest.approx([1.4, 2.1])]},
        {"label": "right_foot", "spans": [pytest.approx([0.7, 1.4])]},
    ]
    assert contact_frames(gait_cycles(walk, 2)) == {"left_foot": "left_foot", "right_foot": "right_foot"}


def test_the_height_asked_for_follows_the_foot(walk):
    """The raised profile of the plan: a parabola of 0.03 m from the last foothold to the next."""
    first, second = clearance_scene(gait_cycles(walk, 2))
    for curve, start, y in ((first, -0.5, -0.08), (second, 0.0, 0.08)):
        points = np.reshape(curve["points"], (-1, 3))
        progress = points[:, 0] - start
        assert progress[0] == pytest.approx(0.0, abs=1e-6)
        assert progress[-1] == pytest.approx(1.0, abs=1e-6)
        np.testing.assert_allclose(points[:, 1], y, atol=1e-6)
        expected = np.maximum(0.12 * progress * (1.0 - progress), 0.0)
        np.testing.assert_allclose(points[:, 2], expected, atol=2e-5)
        np.testing.assert_array_equal(curve["ground"], 0.0)
    assert (second["start"], second["end"]) == pytest.approx((0.7, 1.4))


def test_the_page_of_a_gait_has_its_periods_its_contacts_and_their_curves(walk, tmp_path):
    path = replay(walk, tmp_path / "walk.html", periods=4)
    data = data_of(path)
    assert path.stat().st_size < 2_000_000
    assert "4 × 0.7 s" in path.read_text()
    assert [phase["name"] for phase in data["phases"]] == ["step", "step (mirrored)"] * 2
    assert [trace["frame"] for trace in data["scene"]["traces"]] == ["left_foot", "right_foot"]
    assert data["impacts"] == pytest.approx([0.7, 1.4, 2.1, 2.8])
    groups = {group["name"]: group for group in data["groups"]}
    assert groups["left"]["labels"] == ["left_hip", "left_knee", "left_foot"]
    assert groups["root"]["root"] and groups["root"]["labels"][:3] == ["root_x", "root_z", "root_pitch"]
    *_, force = data["charts"]
    assert (force["title"], force["symbol"]) == ("Normal force of contacts", "fₙ")
    assert [series["label"] for series in force["series"]] == ["left_foot", "right_foot"]
    assert [piece["of"] for piece in force["pieces"]] == [[0], [1], [0], [1]]
    assert force["pieces"][1]["y"] == force["pieces"][0]["y"]
    assert force["pieces"][1]["lower"] == [0.0]
    knees = [[s["label"] for s in data["charts"][0]["series"]].index(f"{side}_knee") for side in ("left", "right")]
    here, later = (data["charts"][0]["pieces"][k]["y"] for k in (0, 1))
    np.testing.assert_allclose(here[knees[0]], later[knees[1]], rtol=1e-5)


def test_one_period_of_a_gait_ends_with_its_impact(walk, tmp_path):
    data = data_of(replay(walk, tmp_path / "step.html"))
    assert [phase["name"] for phase in data["phases"]] == ["step"]
    assert data["impacts"] == [0.7]
    assert [row["label"] for row in data["held"]] == ["left_foot"]


def test_a_plan_without_contacts_has_none_of_this(double_pendulum, wave_plan, tmp_path):
    data = data_of(replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html"))
    assert (data["held"], data["impacts"], data["colors"]) == ([], [], {})
    assert [group["name"] for group in data["groups"]] == ["joints"]
    assert (data["scene"]["contacts"], data["scene"]["clearance"]) == (None, [])


def test_periods_of_a_plan_that_ends_elsewhere_are_refused(double_pendulum, wave_plan, block_plan, tmp_path):
    with pytest.raises(rt.InputError, match="ends elsewhere"):
        replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html", periods=2)
    with pytest.raises(rt.InputError, match="only robots"):
        replay(block_plan, tmp_path / "page.html", periods=2)
    with pytest.raises(rt.InputError, match="whole number"):
        replay(block_plan, tmp_path / "page.html", periods=0)
    assert list(tmp_path.iterdir()) == []


def test_a_flat_foot_is_pushed_at_its_centre_of_pressure():
    robot = rt.load("monopod", root="floating")
    contact = rt.FlatFoot("foot", length=0.2, width=0.1, ground=rt.terrain.Slope(0.0), name="sole").bind(robot)
    q = np.array(robot.neutral)
    anchors = contact.locate(robot, q)
    force, lever = np.array([3.0, 1.0, 50.0]), np.array([0.04, -0.02, 0.0])
    wrench = np.concatenate([force, np.cross(lever, force)])
    forces = SimpleNamespace(forces={"sole": np.tile(wrench, (4, 1))}, q=np.tile(q, (4, 1)))
    phase = SimpleNamespace(robot=robot, bound_contacts=(contact,), name="stand")
    planned = SimpleNamespace(
        phase=phase,
        parameters=anchors,
        t0=0.0,
        duration=1.0,
        knots=[0.0, 1.0],
        at=lambda t, interval=None: tile(t, forces),
    )
    course = gait_cycles(SimpleNamespace(phases=(planned,), problem=SimpleNamespace(links=()), impulses=()))
    hold = Foothold("sole", course.phases[0], contact)
    times, places, pushes = hold.track
    place, _ = contact.spot.placed(robot, q)
    np.testing.assert_allclose(places, np.tile(place + lever, (len(times), 1)), atol=1e-12)
    np.testing.assert_array_equal(pushes, np.tile(force, (len(times), 1)))
    corners = [[-0.1, -0.05, 0.0], [0.1, -0.05, 0.0], [0.1, 0.05, 0.0], [-0.1, 0.05, 0.0]]
    np.testing.assert_allclose(hold.sole, place + np.array(corners), atol=1e-9)
    assert weight_of(robot) == pytest.approx(9.81 * pin.computeTotalMass(robot.model), rel=1e-6)


def tile(t, sample):
    return SimpleNamespace(
        forces={name: np.tile(rows[0], (np.size(t), 1)) for name, rows in sample.forces.items()},
        q=np.tile(sample.q[0], (np.size(t), 1)),
    )


def test_a_contact_that_the_optimum_finds_is_held_while_it_pushes():
    """A mass falls from 0.2 m and stays: its bar starts where it lands."""
    model = pin.Model()
    model.name = "mass"
    x = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "x")
    z = model.addJoint(x, pin.JointModelPZ(), pin.SE3.Identity(), "z")
    model.appendBodyToJoint(z, pin.Inertia(2.0, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("body", z, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    fall = np.sqrt(2 * 0.2 / 9.81)
    phase = rt.Phase(
        rt.load(model, actuated=[]),
        duration=2 * fall,
        contacts=[rt.contacts.ImplicitContact("body", friction=0.5, relaxation=1e-5)],
        start=rt.State(q=[0.0, 0.2], v=0),
        limits=None,
    )
    solution = rt.plan(
        phase,
        mesh=rt.Mesh(50, rt.schemes.RadauIIA(1)),
        continuation=rt.planning.tightening(phase, [1.0, 0.1, 1e-2, 1e-3]),
        check=False,
    )
    course = gait_cycles(solution)
    (bar,) = held(course)
    ((start, end),) = bar["spans"]
    assert start == pytest.approx(fall, abs=4 * fall / 50)
    assert end == pytest.approx(2 * fall)
    scene = contact_scene(course, phase.robot, 0.5)
    (cone,) = scene["cones"]
    assert cone["stays"] is False
    # The first push acts from one step before the ground is reached: implicit Euler.
    np.testing.assert_allclose(cone["apex"], 0.0, atol=9.81 * fall * 2 * fall / 50)
    assert np.tan(cone["angle"]) == pytest.approx(0.5)
