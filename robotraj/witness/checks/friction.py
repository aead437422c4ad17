"""Dry friction as the plan smooths it, against Coulomb's law with sticking.

A plan has the friction F tanh(v / v_s), which is less than Coulomb's F sign(v) where a joint moves more slowly than
v_s. The friction that is missing, in the mean over a phase, is compared with the joint's own load:

    error = max_i (1 / T) integral F_i (1 - |tanh(v_i / v_s)|) [v_i moves] dt / s_i.

A joint that rests sticks under any force up to F. It moves where |v| exceeds ``STILL`` times its size in the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.witness.checks.joint_error import JointError
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import Array, PhaseSolutionLike
from robotraj.witness.sampling import interval_samples

PLACES = (np.arange(9) + 0.5) / 9
"""Places of the samples in an interval, of the midpoint rule."""
STILL = 1e-2
"""Speed below which a joint rests, relative to the size of its speed."""


@dataclass(frozen=True)
class FrictionGap(JointError):
    """The largest mean difference of smoothed from Coulomb friction.

    ``amount`` is the missing friction in the mean, ``size`` the largest force of the joint's motor in the phase, at
    least its friction.
    """

    def __str__(self) -> str:
        return (
            f"{self.joint}: {self.amount:.3g} {self.unit} of Coulomb friction are missing in the mean, "
            f"{100 * self.relative:.2g} percent of {self.size:.3g} {self.unit}"
        )


def friction_gap(
    phases: Sequence[PhaseSolutionLike], sizes: Sequence[Array], clock: Callable[[], None] = lambda: None
) -> FrictionGap | None:
    """Return the worst gap over all robots' phases; None without dry friction.

    Parameters
    ----------
    phases : sequence of PhaseSolution
    sizes : sequence of ndarray (2 nv,)
        Sizes of the differences of states of every phase.
    """
    pairs = zip(phases, sizes, strict=True)
    found = [_gap(planned, own, clock) for planned, own in pairs if planned.phase.robot is not None]
    return max((each for each in found if each is not None), key=lambda each: each.relative, default=None)


def _gap(planned: PhaseSolutionLike, sizes: Array, clock: Callable[[], None]) -> FrictionGap | None:
    robot = realised(planned)
    joints = np.flatnonzero(np.asarray(robot.friction) > 0.0)
    if not joints.size:
        return None
    friction = np.asarray(robot.friction)[joints]
    moving = STILL * sizes[robot.model.nv :][joints]
    motors = np.abs(np.asarray(robot.actuation))[joints]
    loads, missing, whole = friction.copy(), np.zeros(len(joints)), 0.0
    for part in interval_samples(planned, len(PLACES), PLACES):
        clock()
        sample = robot_sample(planned, part.times, part.interval)
        speeds = np.abs(sample.v[:, joints])
        gaps = np.where(speeds > moving, friction * (1.0 - np.tanh(speeds / robot.friction_speed)), 0.0)
        lengths = part.ends - part.begins
        missing += lengths @ gaps.reshape(len(lengths), len(PLACES), -1).mean(axis=1)
        whole += float(lengths.sum())
        loads = np.maximum(loads, (np.abs(sample.tau) @ motors.T).max(axis=0))
    if whole == 0.0:
        return None
    i = int(np.argmax(missing / loads))
    joint = robot.velocity_names[joints[i]]
    unit = TORQUE_UNITS[robot.units[joints[i]]]
    return FrictionGap(joint, str(planned.phase.name), unit, float(missing[i] / whole), float(loads[i]))
