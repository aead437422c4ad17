"""Forward dynamics, energies and axes of models with or without followers.

Pinocchio's ABA and energies do not accept mimic joints; its RNEA and centre of mass do.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array


def accelerations(model: pin.Model, data: pin.Data, q: Array, v: Array, applied: Array) -> Array:
    """Return the accelerations (nv,) under applied torques: ABA, or M^-1 (applied - h) where joints follow others.

    They are NaN where the mass matrix is singular or the state is not finite.
    """
    if not len(model.mimicking_joints):
        return np.asarray(pin.aba(model, data, q, v, applied))
    bias = np.array(pin.nonLinearEffects(model, data, q, v))
    try:
        return np.asarray(np.linalg.solve(mass_matrix(model, data, q), applied - bias))
    except np.linalg.LinAlgError:
        return np.full(model.nv, np.nan)


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """Return M (nv, nv), armature included: CRBA, or column j = RNEA(q, 0, e_j) - RNEA(q, 0, 0) where joints follow.

    With mimic joints, the CRBA of Pinocchio 4.1 adds entries of the call before on the same ``data``.
    """
    if not len(model.mimicking_joints):
        upper = np.triu(pin.crba(model, data, q))  # CRBA writes this half
        return np.asarray(upper + np.triu(upper, 1).T)
    still = np.zeros(model.nv)
    weight = np.array(pin.rnea(model, data, q, still, still))
    return np.column_stack([pin.rnea(model, data, q, still, unit) - weight for unit in np.eye(model.nv)])


def kinetic_energy(model: pin.Model, data: pin.Data, q: Array, v: Array) -> float:
    """Return v' M v / 2 [J], armature included; Pinocchio 4.1 takes armature of another joint behind a free-flyer."""
    return float(0.5 * v @ mass_matrix(model, data, q) @ v)


def potential_energy(model: pin.Model, data: pin.Data, q: Array) -> float:
    """Return minus the sum of m_i g' c_i [J], zero for centres at the world's origin."""
    mass = sum(body.mass for body in model.inertias.tolist()[1:])
    return -float(mass * model.gravity.linear @ pin.centerOfMass(model, data, q))


def joint_axes(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """Return the world Jacobian's columns of the independent joints themselves (6, nv), linear part first.

    Followers are left out. ``pin.computeJointJacobians`` returns columns of all joints in the order of the tree.
    """
    # One column comes back without a second dimension.
    columns = np.asarray(pin.computeJointJacobians(model, data, q)).reshape(6, -1)
    if not len(model.mimicking_joints):
        return columns
    own = [joint for joint in model.joints.tolist()[1:] if joint.nv]
    return columns[:, [joint.idx_vExtended + k for joint in own for k in range(joint.nv)]]
