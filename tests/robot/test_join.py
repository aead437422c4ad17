"""A joined robot moves as its parts do, each at its place."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

PLACE = ((0.9, 0.1, 0.2), (0.0, 0.0, np.sin(0.4), np.cos(0.4)))


@pytest.fixture(scope="module")
def pair():
    parts = {"left": rt.load("ur5"), "right": rt.load("z1")}
    return parts, rt.robot.join(parts, at={"right": PLACE})


def test_names_limits_and_losses_are_those_of_the_parts(pair):
    (left, right), whole = pair[0].values(), pair[1]
    assert whole.joint_names == tuple(
        f"{name}_{joint}" for name, robot in pair[0].items() for joint in robot.joint_names
    )
    assert whole.nu == left.nu + right.nu
    np.testing.assert_array_equal(whole.limits.velocity, np.append(left.limits.velocity, right.limits.velocity))
    np.testing.assert_array_equal(whole.friction, np.append(left.friction, right.friction))
    assert "left_tool0" in whole.frame_names
    assert whole.mass == pytest.approx(left.mass + right.mass)


def test_friction_of_the_whole_is_as_narrow_as_that_of_a_part_with_some():
    ur5, z1, go1 = (rt.load(name) for name in ("ur5", "z1", "go1"))
    beside = {"arm": (1.0, 0.0, 0.0)}
    assert rt.robot.join({"dog": go1, "arm": ur5}, at=beside).friction_speed == go1.friction_speed
    assert rt.robot.join({"dog": go1, "arm": z1}, at=beside).friction_speed == z1.friction_speed


def test_robots_in_the_same_place_are_warned_of():
    ur5 = rt.load("ur5")
    with pytest.warns(UserWarning, match="'left' and 'right' stand in the same place; at="):
        rt.robot.join({"left": ur5, "right": ur5})


def test_dynamics_of_a_part_do_not_depend_on_the_other(pair):
    (left, right), whole = pair[0].values(), pair[1]
    rng = np.random.default_rng(0)
    q, v, a = rng.normal(size=(3, whole.nv))
    n = left.nv
    tau = pin.rnea(whole.model, whole.model.createData(), q, v, a)
    np.testing.assert_allclose(tau[:n], pin.rnea(left.model, left.model.createData(), q[:n], v[:n], a[:n]), atol=1e-10)
    # The other stands turned about the vertical: gravity acts on it as before.
    np.testing.assert_allclose(
        tau[n:], pin.rnea(right.model, right.model.createData(), q[n:], v[n:], a[n:]), atol=1e-10
    )


def test_frames_and_shapes_are_moved_to_their_place(pair):
    (left, right), whole = pair[0].values(), pair[1]
    q = np.random.default_rng(1).normal(size=whole.nq)
    pose = pin.SE3(pin.Quaternion(np.array(PLACE[1])).matrix(), np.array(PLACE[0]))
    data, own = whole.model.createData(), right.model.createData()
    pin.framesForwardKinematics(whole.model, data, q)
    pin.framesForwardKinematics(right.model, own, q[left.nq :])
    for name in right.frame_names[1:]:
        found, expected = data.oMf[whole.frame(f"right_{name}")], pose * own.oMf[right.frame(name)]
        np.testing.assert_allclose(found.homogeneous, expected.homogeneous, atol=1e-12)
    shapes, alone = whole.collision_model, right.collision_model
    placed, there = shapes.createData(), alone.createData()
    pin.updateGeometryPlacements(whole.model, data, shapes, placed)
    pin.updateGeometryPlacements(right.model, own, alone, there)
    for i, shape in enumerate(alone.geometryObjects):
        k = shapes.getGeometryId(f"right_{shape.name}")
        np.testing.assert_allclose(placed.oMg[k].homogeneous, (pose * there.oMg[i]).homogeneous, atol=1e-12)


def test_two_arms_are_planned_as_each_alone(tmp_path):
    arm = rt.load("two_link_arm")
    both = rt.robot.join({"a": arm, "b": arm}, at={"b": (1.0, 0.0, 0.0)})
    start, end = [0.0, 0.0, 0.5, -0.5], [0.5, 0.4, -0.3, 0.2]

    def reach(robot, first, last):
        return rt.Phase(robot, 1.0, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort(), limits=None)

    plan = rt.plan(reach(both, start, end), mesh=rt.Mesh(10))
    alone = [rt.plan(reach(arm, start[i : i + 2], end[i : i + 2]), mesh=rt.Mesh(10)).objective for i in (0, 2)]
    assert plan.objective == pytest.approx(sum(alone), rel=1e-6)
    assert rt.validate(plan).passed
    again = rt.load_solution(plan.save(tmp_path / "both.npz"))
    np.testing.assert_array_equal(again.at(0.3).q, plan.at(0.3).q)
    assert len(again.phases[0].phase.robot.visual_model.geometryObjects) == 2 * len(arm.visual_model.geometryObjects)
    assert rt.replay(again, tmp_path / "both.html").is_file()


@pytest.mark.parametrize(
    ("robots", "at", "message"),
    [
        ({"a": "two_link_arm"}, {}, "two robots"),
        ({"a": "two_link_arm", "b": None}, {}, "NoneType"),
        ({"a": "two_link_arm", "b": "two_link_arm"}, {"c": (0, 0, 0)}, "'c'"),
        ({"a": "two_link_arm", "b": "two_link_arm"}, {"b": (0, 0)}, "position"),
        ({"a": "two_link_arm", "b": "two_link_arm"}, {"b": ((0, 0, 0), (0, 0, 0, 2))}, "quaternion"),
    ],
)
def test_bad_input(robots, at, message):
    loaded = {name: rt.load(source) if source else source for name, source in robots.items()}
    with pytest.raises(rt.InputError, match=message):
        rt.robot.join(loaded, at=at)


def test_moving_roots_are_refused():
    with pytest.raises(rt.InputError, match="floating root"):
        rt.robot.join({"a": rt.load("solo12", root="floating"), "b": rt.load("ur5")})
