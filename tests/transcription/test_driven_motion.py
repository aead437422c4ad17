"""Forces and torques along a motion: the equations of motion hold between the collocation points too."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.transcription.driven_motion import DrivenInputs, MotionEquations, PlannedInputs, inputs_of, is_driven
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.error import interval_errors

SITES = np.array([0.0, 0.5, 1.0])


def swinging(x: np.ndarray, a: float, robot: rt.Robot) -> DrivenInputs:
    """Return the inputs of a pendulum of states x (3, 2) at the sites and acceleration a, planned torque 0."""
    breaks = np.array([0.0, 1.0])
    curves = [PiecewisePolynomial(breaks, [SITES], [values]) for values in (x, np.full((3, 1), a), np.zeros((3, 1)))]
    phase = rt.Phase(robot, 1.0)
    return DrivenInputs(phase, PhaseTrajectory(0.0, 1.0, *curves, SITES, {}))


def test_a_rod_that_swings_needs_inertia_weight_damping_and_friction() -> None:
    """q = t^2 / 2: tau = I + m g l sin q + d t + F tanh(t / v_s) of a rod of one joint."""
    robot = rt.load("pendulum")
    t = np.linspace(0.0, 1.0, 7)
    _, u = swinging(np.stack([0.5 * SITES**2, SITES], axis=1), 1.0, robot).at(t)
    model, data = robot.model, robot.model.createData()
    for time, value in zip(t, u[:, 0], strict=True):
        q, v = np.array([0.5 * time**2]), np.array([time])
        mass, bias = pin.crba(model, data, q)[0, 0], pin.nonLinearEffects(model, data, q, v)[0]
        drag = robot.damping[0] * time + robot.friction[0] * np.tanh(time / robot.friction_speed)
        assert value == pytest.approx(mass + bias + drag, rel=1e-12)
    _, rest = swinging(np.zeros((3, 2)), 0.0, robot).at(0.0)
    assert rest == pytest.approx(pin.computeGeneralizedGravity(model, data, np.zeros(1)), abs=1e-12)


def test_times_and_places_inside_intervals_agree() -> None:
    robot = rt.load("ur5")
    solution = rt.plan(rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort()), mesh=rt.Mesh(4))
    (part,) = solution.phases
    places = np.array([0.25, 0.5, 0.75])
    times = part.knots[:-1, None] + np.diff(part.knots)[:, None] * places
    for inside, at in zip(part.inputs.inside(places), part.inputs.at(times.ravel()), strict=True):
        assert inside.reshape(len(at), -1) == pytest.approx(at, abs=1e-9)
    assert part.at(0.3).tau == pytest.approx(part.inputs.at(np.array([0.3]))[1][0], abs=1e-12)
    assert part.at(0.3).u["tau.elbow_joint"] == pytest.approx(part.at(0.3).tau[2], abs=1e-12)


@pytest.fixture(scope="module")
def step() -> rt.Solution:
    robot = rt.load("talos_legs", root="floating")
    feet, sole = ("left_sole_link", "right_sole_link"), partial(rt.FlatFoot, length=0.2, width=0.12)
    shift = rt.gait.steps(robot, [{feet[1]: (0.05, -0.085)}], feet=feet, contact=sole, swing=0.6, shift=0.4)
    return rt.plan(shift, mesh=[rt.Mesh(5)] * 3)


def test_a_foot_balances_the_root_at_all_times(step: rt.Solution) -> None:
    """Plain Pinocchio: RNEA - J' f - B tau = 0 in all rows, where a sole can carry any wrench."""
    part = step.phases[1]
    (contact,) = part.phase.bound_contacts
    robot, times = part.robot, np.linspace(part.t0, part.t0 + part.duration, 41)
    assert robot is not None
    model, data, sample = robot.model, robot.model.createData(), part.at(times)
    planned = part.trajectory.z(times)
    for i in range(len(times)):
        pin.computeJointJacobians(model, data, sample.q[i])
        pin.updateFramePlacements(model, data)
        jacobian = pin.getFrameJacobian(model, data, robot.frame(contact.frame), pin.LOCAL_WORLD_ALIGNED)
        left = pin.rnea(model, data, sample.q[i], sample.v[i], planned[i, : robot.nv]) + robot.dissipation(sample.v[i])
        left -= jacobian.T @ sample.forces[contact.name][i] + robot.actuation @ sample.tau[i]
        assert np.abs(left).max() < 1e-6


def test_inputs_of_legs_equal_the_planned_ones_at_collocation_points(step: rt.Solution) -> None:
    for part in step.phases:
        for driven, planned in zip(
            part.inputs.inside(SITES), PlannedInputs(part.trajectory).inside(SITES), strict=True
        ):
            assert driven == pytest.approx(planned, abs=1e-6 * np.abs(planned).max())


def test_the_motion_errs_less_than_its_polynomials_of_forces_and_torques(step: rt.Solution) -> None:
    part = step.phases[1]
    driven = interval_errors(part.phase, part.trajectory, part.inputs).max()
    assert driven < 0.7 * interval_errors(part.phase, part.trajectory).max()


def test_inputs_of_an_arm_equal_the_planned_ones_at_knots() -> None:
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    (part,) = rt.plan(phase, mesh=rt.Mesh(4)).phases
    knots = SITES[[0, 2]]
    for driven, planned in zip(part.inputs.inside(knots), PlannedInputs(part.trajectory).inside(knots), strict=True):
        assert driven == pytest.approx(planned, abs=1e-5 * np.abs(planned).max())


def test_slopes_of_the_rows_are_their_finite_differences(step: rt.Solution) -> None:
    part = step.phases[0]
    equations, times = MotionEquations.of(part.phase), np.array([0.1, 0.2, 0.3])
    x, (z, u) = part.trajectory.x(times), part.inputs.at(times)
    p = np.array(list(part.parameters.values()))
    slopes = equations.slopes(times, x, z, u, p)
    for k in range(z.shape[1]):
        change = np.zeros(z.shape[1])
        change[k] = 1.0
        # The rows are linear in accelerations and forces.
        ahead, behind = (equations.rows(times, x, z + sign * change, u, p) for sign in (1.0, -1.0))
        assert slopes[:, :, k] == pytest.approx(0.5 * (ahead - behind), abs=1e-8)


def test_motions_whose_torques_are_not_free_are_read_from_polynomials() -> None:
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    assert is_driven(phase, (rt.HermiteSimpson(),))
    assert not is_driven(phase, (rt.HermiteSimpson(control=rt.schemes.LinearControl()),))
    assert not is_driven(rt.Phase(rt.load("acrobot"), 1.0), (rt.HermiteSimpson(),))
    walker, foot = rt.load("compass_walker", root="planar"), rt.PointContact("left_foot")
    motor = rt.PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor", unit="N m")
    assert is_driven(rt.Phase(walker, 1.0, contacts=[foot]), (rt.HermiteSimpson(),))
    assert not is_driven(rt.Phase(walker, 1.0, contacts=[foot], constraints=[motor]), (rt.HermiteSimpson(),))
    (part,) = rt.plan(phase, mesh=rt.Mesh(4, rt.HermiteSimpson(control=rt.schemes.LinearControl()))).phases
    assert isinstance(inputs_of(part.phase, part.trajectory, part.mesh.schemes), PlannedInputs)
