"""The mirrored half of a gait is simulated with the mirror image of the robot; symmetric inertia has none."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness.simulation.mirror_image import mirror_image, mirror_of


def signed(robot, mirror):
    """Return the matrix from velocities to those of the mirrored motion, from the signs of its states."""
    both = {**mirror.partners, **{b: a for a, b in mirror.partners.items()}}
    names = list(robot.velocity_names)
    matrix = np.zeros((robot.nv, robot.nv))
    for i, name in enumerate(names):
        partner = both.get(name, name)
        matrix[i, names.index(partner)] = -1.0 if partner in mirror.negated else 1.0
    return matrix


@pytest.mark.parametrize("name", ["hyq", "a1", "solo12"])
def test_the_image_needs_the_torques_of_the_robot_in_the_mirrored_motion(name):
    robot = rt.load(name, root="floating")
    mirror = rt.gait.mirror(robot, tolerance=2e-2, imbalance=1.0)
    image = mirror_image(robot, mirror)
    assert image is not None
    rng = np.random.default_rng(2)
    v, a = rng.normal(size=(2, robot.nv))
    joints = rng.uniform(-0.5, 0.5, robot.nv - 6)
    turn = rng.normal(size=3) * 0.3
    swap = signed(robot, mirror)
    # Roll and yaw change their sign, pitch does not.
    quaternion, turned = (
        pin.Quaternion(pin.exp3(part)).coeffs() for part in (turn, np.array([-1.0, 1.0, -1.0]) * turn)
    )
    q = np.concatenate([[0.1, 0.2, 0.3], quaternion, joints])
    mirrored = np.concatenate([[0.1, -0.2, 0.3], turned, (swap[6:, 6:] @ joints)])
    own = pin.rnea(image.model, image.model.createData(), q, v, a)
    needed = pin.rnea(robot.model, robot.model.createData(), mirrored, swap @ v, swap @ a)
    weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
    # Joints are within the tolerance of the mirror where their images are.
    np.testing.assert_allclose(swap @ own, needed, atol=5e-3 * weight)
    unchanged = pin.rnea(robot.model, robot.model.createData(), q, v, a)
    if name == "hyq":
        assert np.abs(swap @ unchanged - needed).max() > 2e-2 * weight


def test_a_robot_with_symmetric_inertia_is_its_own_image():
    robot = rt.load("solo12", root="floating")
    mirror = rt.gait.mirror(robot)
    image = mirror_image(robot, mirror)
    # The mean of both is symmetric.
    model = pin.Model(robot.model)
    for i in range(1, model.njoints):
        own, other = robot.model.inertias[i], image.model.inertias[i]
        mass = (own.mass + other.mass) / 2
        model.inertias[i] = pin.Inertia.FromDynamicParameters(
            (own.toDynamicParameters() + other.toDynamicParameters()) / 2
        )
        assert model.inertias[i].mass == pytest.approx(mass)
    symmetric = dataclasses.replace(robot, model=model)
    again = mirror_image(symmetric, mirror)
    if again is not None:
        for own, other in zip(model.inertias, again.model.inertias, strict=True):
            np.testing.assert_allclose(own.matrix(), other.matrix(), atol=1e-5 * max(1e-3, own.mass))


def test_inertias_are_compared_relative_to_their_size():
    """A robot of a billionth of the mass has an image as well; differences of round-off are none at any mass."""
    robot = rt.load("hyq", root="floating")
    mirror = rt.gait.mirror(robot, tolerance=2e-2, imbalance=1.0)
    for scale in (1e-9, 1e9):
        model = pin.Model(robot.model)
        for i in range(1, model.njoints):
            model.inertias[i] = pin.Inertia.FromDynamicParameters(scale * robot.model.inertias[i].toDynamicParameters())
        assert mirror_image(dataclasses.replace(robot, model=model), mirror) is not None


def test_links_that_repeat_a_motion_as_it_is_have_no_mirror():
    assert mirror_of(SimpleNamespace(problem=SimpleNamespace(links=(rt.Periodic(),)))) is None
    mirror = rt.Mirror(partners={"left": "right"})
    assert mirror_of(SimpleNamespace(problem=SimpleNamespace(links=(mirror,)))) is mirror
    touchdown = rt.Touchdown(0, 0, repeat=mirror)
    assert mirror_of(SimpleNamespace(problem=SimpleNamespace(links=(touchdown,)))) is mirror
