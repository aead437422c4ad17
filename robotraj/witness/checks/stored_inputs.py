"""Torques, accelerations and contact forces that a plan stores, against those of its motion.

A solution stores the controls and algebraic variables at its collocation points. Its samples are those that the planned
motion needs, and agree with them there as far as the motion is exact. Where they do not, an export or a further plan,
which are made from the stored ones, differ from the motion that was judged.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.design.binding import realised
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike


def stored_off(planned: PhaseSolutionLike) -> Array:
    """Return the generalised force (nv,) by which what a robot's phase stores differs from its motion.

    It is the largest mean over the points of an interval: at one end of it a motion may need other torques, while the
    plan is right as a whole. Zero on a given path, whose variables are those of the path, and for plans that store
    nothing.
    """
    robot, phase = realised(planned), planned.phase
    model, data = robot.model, robot.model.createData()
    stored = getattr(planned, "trajectory", None)
    if stored is None or phase.path is not None:
        return np.zeros(model.nv)
    times = np.asarray(stored.points, dtype=float)
    knots = np.asarray(planned.knots, dtype=float)
    interval = np.clip(np.searchsorted(knots, times) - 1, 0, len(knots) - 2)
    sample = robot_sample(planned, times, interval)
    known = dict(zip((v.name for v in phase.dae.algebraic), stored.z(times, interval).T, strict=True))
    known |= dict(zip((v.name for v in phase.dae.controls), stored.u(times, interval).T, strict=True))
    off = np.zeros((len(times), model.nv))
    for variable, own, axis in zip(phase.body.controls, sample.tau.T, np.asarray(robot.actuation).T, strict=False):
        off += np.abs(np.outer(known.get(variable.name, own) - own, axis))
    a = np.column_stack(
        [known.get(f"a.{name}", own) for name, own in zip(robot.velocity_names, sample.a.T, strict=True)]
    )
    contacts = phase.bound_contacts
    stance = Stance(robot, contacts, planned.parameters) if contacts else None
    for i, (q, v) in enumerate(zip(sample.q, sample.v, strict=True)):
        off[i] += np.abs(pin.rnea(model, data, q, v, a[i]) - pin.rnea(model, data, q, v, sample.a[i]))
        if stance is not None:
            forces = forces_in(sample, contacts, i)
            told = {
                contact.name: np.array([known.get(f.name, sample.z[f.name])[i] for f in contact.forces], dtype=float)
                for contact in contacts
            }
            off[i] += np.abs(stance.torques(q, told) - stance.torques(q, forces))
    off = np.nan_to_num(off, nan=np.inf)
    means = [off[interval == k].mean(axis=0) for k in np.unique(interval)]
    return np.max(means, axis=0) if means else np.zeros(model.nv)
