"""One run in closed form: what the controller measures, how bodies and friction are drawn, and the defaults."""

import copy
from dataclasses import astuple, dataclass, replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.witness.mujoco.model import mujoco_robot

mujoco = pytest.importorskip("mujoco")

CALM = rt.witness.Disturbances(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
LIMIT, DURATION = 2.0, 0.3


@dataclass(frozen=True)
class SameModel(rt.witness.Disturbances):
    """The model is not disturbed, and draws no random numbers."""

    def of_model(self, mujoco, model, rng):
        return copy.copy(model)


@pytest.fixture(scope="module")
def hang():
    """A pendulum at rest below its joint, whose planned torque is 0."""
    pendulum = rt.load("pendulum")
    rest = rt.State(q=0, v=0)
    limits = pendulum.limits.with_(effort=LIMIT)
    return rt.plan(rt.Phase(pendulum, DURATION, rest, rest, rt.Effort(), limits=limits), mesh=rt.Mesh(10))


@pytest.mark.parametrize(("position", "velocity"), [(1e-3, 0.0), (0.0, 1e-3), (2e-3, 3e-3)])
def test_the_first_torque_answers_the_noise_of_both_sensors(hang, position, velocity):
    """In a run of one period the feedback is K (n_q, n_v), and the reserve is the limit."""
    drawn = SameModel(*astuple(replace(CALM, position_noise=position, velocity_noise=velocity)))
    found = rt.witness.monte_carlo(hang, runs=3, disturbances=drawn, seed=4, rate=1.0 / DURATION)
    assert found.times == pytest.approx([0.0, DURATION])
    for used, child in zip(found.used, np.random.SeedSequence(4).spawn(3), strict=True):
        rng = np.random.default_rng(child)
        rng.standard_normal(2)  # the first state
        drawn.push_of(2, DURATION, rng)
        measured = np.array([position, velocity]) * rng.standard_normal(2)
        assert used == pytest.approx(abs(float((hang.gains.at(0.0) @ measured)[0])) / LIMIT, rel=1e-6)


@pytest.mark.parametrize(("position", "velocity"), [(0.02, 0.0), (0.0, 0.05), (0.02, 0.5)])
def test_the_first_state_is_off_by_the_first_random_numbers(hang, position, velocity):
    drawn = SameModel(*astuple(replace(CALM, position=position, velocity=velocity)))
    found = rt.witness.monte_carlo(hang, runs=1, disturbances=drawn, seed=6)
    off = np.array([position, velocity]) * np.random.default_rng(np.random.SeedSequence(6).spawn(1)[0]).standard_normal(
        2
    )
    assert found.deviations[0, 0] == pytest.approx(abs(off[0]), abs=1e-12)
    assert found.deviations[0, 1] == pytest.approx(abs(off[0] + found.times[1] * off[1]), abs=1e-4 * np.abs(off).max())


def test_masses_and_friction_are_multiplied_by_exponentials_of_their_random_numbers():
    arm = rt.load("z1")
    model = mujoco_robot(arm).model
    drawn = rt.witness.Disturbances(mass=0.3, friction=0.5)
    other = drawn.of_model(mujoco, model, np.random.default_rng(8))
    rng = np.random.default_rng(8)
    heavier, rougher = np.exp(0.3 * rng.standard_normal(model.nbody)), np.exp(0.5 * rng.standard_normal(model.nv))
    np.testing.assert_allclose(other.body_mass, heavier * model.body_mass)
    np.testing.assert_allclose(other.body_inertia, heavier[:, None] * model.body_inertia)
    np.testing.assert_allclose(other.dof_damping, rougher * model.dof_damping)
    np.testing.assert_allclose(other.dof_frictionloss, rougher * model.dof_frictionloss)
    assert np.any(model.dof_damping > 0) and np.any(model.dof_frictionloss > 0)


def test_a_bound_of_a_tenth_and_a_kilohertz_are_the_defaults(hang):
    found = rt.witness.monte_carlo(hang, runs=1)
    margin = rt.witness.disturbance_margin(hang, runs=1)
    for runs in (found, margin.runs):
        assert runs.bound == 0.1 and runs.disturbances.delay / rt.witness.Disturbances().delay in (1.0, margin.factor)
        assert len(runs.times) == 1 + round(1000.0 * DURATION) and "controller at 1000 Hz" in runs.how


def test_the_funnel_begins_at_zero_deviation(hang):
    found = rt.witness.monte_carlo(hang, runs=2)
    heights = [collection.get_paths()[0].vertices[:, 1] for collection in found.plot().axes[0].collections]
    assert [height.min() for height in heights] == [0.0, 0.0, 0.0]
    assert max(height.max() for height in heights) == pytest.approx(found.worst.max())
