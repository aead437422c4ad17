"""Rotor inertias enter the armature, which is what Pinocchio's algorithms use."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import robotraj as rt


def test_rotor_inertia_times_gear_ratio_squared_is_added_to_the_mass_matrix():
    model = pin.buildSampleModelManipulator()
    rng = np.random.default_rng(6)
    model.rotorInertia[:] = rng.uniform(1e-5, 1e-4, model.nv)
    model.rotorGearRatio[:] = rng.uniform(50, 150, model.nv)
    robot = rt.load(model)
    q = rng.uniform(-1, 1, model.nq)
    added = pin.crba(robot.model, robot.model.createData(), q) - pin.crba(model, model.createData(), q)
    np.testing.assert_allclose(added, np.diag(model.rotorInertia * model.rotorGearRatio**2), atol=1e-12)
    assert any("rotor inertias" in note for note in robot.notes)


def test_an_armature_that_is_there_stays():
    model = pin.buildSampleModelManipulator()
    model.rotorInertia[:] = 1.0
    model.armature[0] = 0.25
    np.testing.assert_array_equal(rt.load(model).model.armature, [0.25, 1, 1, 1, 1, 1])


def test_talos_takes_its_rotors_from_the_srdf():
    robot = rt.load("talos")
    assert robot.model.armature[robot.joint("arm_left_1_joint")] == 1e-5 * 100**2
    assert any("talos.srdf" in note for note in robot.notes)


def test_a_plain_urdf_has_none():
    assert not np.any(rt.load("ur5").model.armature)
    assert not any("rmature" in note for note in rt.load("ur5").notes)
