"""The error of joints whose damping is strong for their inertia: their residual is large, their motion is right."""

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.transcription.refinement.error import interval_errors, residuals_of


def robot(damping):
    """Return a driven link that carries a free one of 1e-7 kg m^2."""
    model, place = pin.Model(), pin.SE3.Identity()
    big = model.addJoint(0, pin.JointModelRY(), place, "big")
    model.appendBodyToJoint(big, pin.Inertia(2.0, np.array([0, 0, 0.3]), 0.1 * np.eye(3)), place)
    tiny = model.addJoint(big, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0, 0, 0.5])), "tiny")
    model.appendBodyToJoint(tiny, pin.Inertia(1e-3, np.array([0, 0, 0.01]), 1e-7 * np.eye(3)), place)
    model.damping = np.array([0.1, damping])
    return rt.load(model, actuated=["big"])


def test_damping_of_a_tiny_inertia_is_no_error_of_the_motion():
    end = rt.State(q={"big": 1.0}, v={"big": 0.0})
    phase = rt.Phase(robot(1.0), 1.0, rt.State(q=[0, 0], v=0), end, rt.Effort())
    plan = rt.plan(phase, rt.Mesh(20))
    # Parts of the plan, simulated by themselves, are right to a thousandth; the estimate is on the safe side.
    local = rt.validate(plan).local.worst.relative
    assert local < 1e-3
    assert local < plan.error < 1.0
    # The residual itself, without its decay, would be an error far above the whole motion.
    part = plan.phases[0]
    undamped = residuals_of(part.phase, part.trajectory, part.inputs)._replace(decay=None)
    assert interval_errors(part.phase, part.trajectory, residuals=undamped).max() > 10.0


def test_without_damping_the_estimate_is_the_integral_of_the_residual():
    phase = rt.Phase(rt.load("acrobot"), 1.0, rt.State(q=[0, 0], v=0), rt.State(q=[0.5, -1], v=0), rt.Effort())
    errors = [rt.plan(phase, rt.Mesh(count)).error for count in (10, 20)]
    assert 6 < errors[0] / errors[1] < 40
