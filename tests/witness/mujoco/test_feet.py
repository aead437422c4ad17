from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.witness.mujoco import mujoco_robot
from robotraj.witness.mujoco.feet import Foot, feet_of, furnish
from robotraj.witness.mujoco.reference_motion import ReferenceMotion

mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")

GROUNDS = {
    "flat": (rt.terrain.Flat(0.2), 1e-12),
    "slope": (rt.terrain.Slope(0.3, -0.2, 0.1), 1e-12),
    "waves": (rt.terrain.HeightFunction(lambda x, y: 0.05 * ca.sin(3 * x) + 0.03 * ca.cos(2 * y)), 1e-4),
}


def resting(robot, contacts, q):
    """A plan that stays at q."""

    def at(t, interval=None):
        many = np.shape(t)
        return SimpleNamespace(
            q=np.broadcast_to(q, (*many, robot.nq)),
            v=np.zeros((*many, robot.nv)),
            a=np.zeros((*many, robot.nv)),
            tau=np.zeros((*many, robot.nu)),
            z={},
            forces={},
        )

    bound = tuple(contact.bind(robot) for contact in contacts)
    phase = SimpleNamespace(name="rest", robot=robot, limits=None, bound_contacts=bound)
    plan = SimpleNamespace(phase=phase, knots=np.array([0.0, 0.1]), parameters={}, at=at)
    return SimpleNamespace(phases=(plan,), problem=SimpleNamespace(links=()))


def standing(robot, frame, place, rotation=None):
    """Return the configuration (nq,) whose frame is at a place with a rotation."""
    q = np.array(robot.neutral)
    q[7:] = np.linspace(0.3, -0.6, robot.nq - 7)
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, q)
    foot = data.oMf[robot.frame(frame)]
    goal = pin.SE3(foot.rotation if rotation is None else rotation, np.asarray(place, dtype=float))
    q[:7] = pin.SE3ToXYZQUAT(goal * foot.inverse() * pin.XYZQUATToSE3(q[:7]))
    return q


def distances(robot, contact, q):
    """Return the distances [m] of MuJoCo's contacts while the plan's foot is on the ground."""
    course = ReferenceMotion(resting(robot, [contact], q))
    feet = feet_of(course)
    soft = rt.witness.SoftGround(radius=0.01)
    second = mujoco_robot(robot, None, lambda spec, bodies: furnish(course, feet, soft, spec, bodies))
    # A margin of 1 mm detects contacts that just touch the ground.
    second.model.geom_margin[:] = 1e-3
    data = mujoco.MjData(second.model)
    data.qpos[:] = second.coordinates.qpos(q)
    mujoco.mj_forward(second.model, data)
    return np.array(data.contact.dist)


@pytest.fixture(scope="module")
def monopod():
    return rt.load("monopod", root="floating")


@pytest.mark.parametrize(("ground", "tolerance"), GROUNDS.values(), ids=GROUNDS)
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.02, -0.01, -0.03)], ids=["frame", "beside"])
def test_a_point_foot_touches_where_the_plan_holds_it(monopod, ground, tolerance, offset):
    x, y = 0.37, -0.22
    contact = rt.PointContact("foot", ground=ground, offset=offset)
    q = standing(monopod, "foot", [0.0, 0.0, 0.0])
    data = monopod.model.createData()
    pin.framesForwardKinematics(monopod.model, data, q)
    at = data.oMf[monopod.frame("foot")].act(np.array(offset))
    q[:3] += np.array([x, y, float(ground.height(x, y))]) - at
    found = distances(monopod, contact, q)
    assert len(found) >= 1 and abs(found.min()) < tolerance


@pytest.mark.parametrize(("ground", "tolerance"), list(GROUNDS.values())[:2], ids=list(GROUNDS)[:2])
def test_soles_and_edges_lie_on_the_ground(monopod, ground, tolerance):
    x, y = 0.37, -0.22
    first, second, normal = (np.array(axis, dtype=float) for axis in ground.axes(x, y))
    q = standing(monopod, "foot", [x, y, float(ground.height(x, y))], np.column_stack([first, second, normal]))
    axes = {"normal": (0, 0, 1), "forward": (1, 0, 0)}
    sole = rt.FlatFoot("foot", length=(0.05, 0.15), width=0.08, ground=ground, **axes)
    corners = distances(monopod, sole, q)
    assert len(corners) == 4 and np.abs(corners).max() < 1e-9
    edge = rt.contacts.LineContact("foot", width=0.1, ground=ground, direction=(0, 1, 0))
    ends = distances(monopod, edge, q)
    assert len(ends) == 2 and np.abs(ends).max() < 1e-9


def test_feet_touch_their_own_ground_alone(monopod):
    q = standing(monopod, "foot", [0.0, 0.0, 0.0])
    low, high = (
        rt.PointContact("foot"),
        rt.PointContact("foot", name="other", ground=rt.terrain.Flat(0.5), offset=(0, 0, 0.5)),
    )
    course = ReferenceMotion(resting(monopod, [low, high], q))
    feet = feet_of(course)
    second = mujoco_robot(
        monopod, None, lambda spec, bodies: furnish(course, feet, rt.witness.SoftGround(), spec, bodies)
    )
    second.model.geom_margin[:] = 1e-3
    data = mujoco.MjData(second.model)
    q[2] -= 1e-4
    data.qpos[:] = second.coordinates.qpos(q)
    mujoco.mj_forward(second.model, data)
    pairs = {tuple(second.model.geom(int(g)).name for g in pair) for pair in data.contact.geom}
    assert ("ground 0", "foot") in pairs and not any(
        pair in pairs for pair in [("ground 1", "foot"), ("ground 0", "other")]
    )


class Rod:
    """A contact kind of one's own on flat ground."""

    ground = rt.terrain.Flat()


def test_other_contacts_are_refused(monopod):
    q = standing(monopod, "foot", [0.0, 0.0, 0.0])
    course = ReferenceMotion(resting(monopod, [rt.PointContact("foot")], q))
    course.phases[0].phase.bound_contacts = (SimpleNamespace(name="rod", contact=Rod(), frame="foot", holds=()),)
    with pytest.raises(InputError, match="Rod 'rod' cannot be simulated in MuJoCo"):
        feet_of(course)


@pytest.fixture(scope="module")
def squat():
    hopper = rt.load("hopper", root="planar")
    phase = rt.Phase(
        hopper,
        duration=0.5,
        start=rt.State(q=[0, 0.5, 0, 0, 0.5], v=0),
        end=rt.State(q=[0, 0.45, 0, 0, 0.45], v=0),
        contacts=[rt.PointContact("foot")],
        objective=rt.Effort(),
        name="squat",
    )
    return rt.plan(phase, mesh=rt.Mesh(8, rt.HermiteSimpson()))


def test_a_squatting_foot_stays_and_carries_the_weight(squat):
    opinion = rt.witness.second_opinion(squat)
    assert opinion.completed and opinion.upright
    assert opinion.slip < 1e-9 and opinion.sink < 1e-3
    assert opinion.deviation.largest("q.") < 2e-3
    (foot,) = opinion.feet
    assert (foot.name, foot.stances, foot.loaded) == ("foot", 1, pytest.approx(1.0, abs=0.01))
    # The robot is at rest before and after, so that the ground gives its weight on the average.
    assert foot.force == pytest.approx([0.0, 0.0, 3.5 * 9.81], abs=0.05)
    assert foot.planned == pytest.approx([0.0, 0.0, 3.5 * 9.81], abs=1e-6)
    assert "completed the plan, upright" in str(opinion) and "mean force" in str(opinion)


def test_a_flat_foot_balances_a_robot_in_space(monopod):
    q = np.array(monopod.neutral)
    q[7:] = [0.0, -0.5, 1.0]
    data = monopod.model.createData()
    pin.framesForwardKinematics(monopod.model, data, q)
    foot = data.oMf[monopod.frame("foot")]
    q[2] -= foot.translation[2]
    # The sole is level under a leaning shank: its axes in the foot's frame are those of the world.
    axes = {"normal": foot.rotation.T[:, 2], "forward": foot.rotation.T[:, 0]}
    sole = rt.FlatFoot("foot", length=0.2, width=0.1, friction=0.5, normal_force=(1.0, np.inf), **axes)
    shift = rt.Phase(
        monopod,
        duration=0.3,
        start=rt.State(q=q, v=0),
        end=rt.State(q={"root_x": q[0] + 0.02}, v=0),
        contacts=[sole],
        objective=rt.Effort(),
    )
    opinion = rt.witness.second_opinion(rt.plan(shift, mesh=rt.Mesh(6, rt.HermiteSimpson())))
    assert opinion.completed and opinion.deviation.largest("q.") < 0.02
    assert opinion.slip < 1e-3 and opinion.sink < 1e-3
    (report,) = opinion.feet
    assert report.force == pytest.approx(report.planned, abs=0.02 * 1.15 * 9.81)


def test_harder_ground_gives_way_less(squat):
    soft, hard = (
        rt.witness.second_opinion(squat, ground=rt.witness.SoftGround(time=time)).sink for time in (0.02, 0.004)
    )
    assert hard < 0.2 * soft


def test_a_fall_is_reported_with_its_reason(squat):
    opinion = rt.witness.second_opinion(
        squat, feedback=rt.witness.NoFeedback(), offset=[0, 0, 0, 0, 0, 0, 0, 4.0, 0, 0]
    )
    assert not opinion.completed and not opinion.upright
    assert 0.05 < opinion.fell < 0.5
    assert opinion.deviation["q.root_pitch"].final == np.inf
    assert f"the robot fell at t = {opinion.fell:.4g} s" in str(opinion)
    assert "root is turned by" in opinion.failure or "centre of mass is" in opinion.failure


def test_ice_is_slippery():
    hopper = rt.load("hopper", root="planar")
    lean = rt.Phase(
        hopper,
        duration=0.3,
        start=rt.State(q=[0, 0.5, 0, 0, 0.5], v=0),
        end=rt.State(q={"root_x": 0.05}, v=0),
        contacts=[rt.PointContact("foot")],
        objective=rt.Effort(),
    )
    solution = rt.plan(lean, mesh=rt.Mesh(8, rt.HermiteSimpson()))
    rough, ice = (rt.witness.second_opinion(solution, ground=rt.witness.SoftGround(grip=grip)) for grip in (1.5, 0.05))
    assert rough.slip < 2e-3 < 2e-2 < ice.slip
    assert replace(rough, fell=0.1).completed is False


def test_a_foot_on_ground_and_wall_touches_the_nearer_one() -> None:
    grounds = (rt.terrain.Flat(), rt.terrain.Plane((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)))
    foot = Foot("foot", 0, pin.SE3.Identity(), "SPHERE", (), 0.7, grounds)
    assert foot.touched(np.array([0.9, 0.0, 0.5])) == grounds[1]
    assert foot.touched(np.array([0.2, 0.0, 0.5])) == grounds[0]
