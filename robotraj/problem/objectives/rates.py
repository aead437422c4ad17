"""Squared rates: of torques and of accelerations."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.augmentation import body_of
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.rates_as_variables import with_control_rates, with_jerks
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class TorqueRate(Integral):
    """Integral over the phase of sum_j w_j (d tau_j / dt)^2 [N^2 m^2 / s].

    The torques (controls of a System) become states and their rates the controls. So torques are continuous within the
    phase and as smooth as the scheme's states; their ends are free. ``point.u`` and the phase's ``controls=`` still
    refer to the torques. ``rt.constraints.JointTorqueRate`` bounds the rates.

    Parameters
    ----------
    weights : None, number, sequence or mapping by joint
        One weight per actuated joint (per control of a System), 1 by default.
    """

    weights: WeightsLike = None

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared rates."""
        names = list(point.u)
        weights = weights_of(self.weights, [n.removeprefix("tau.") for n in names], "TorqueRate")
        return sum((w * point.extra[f"rate.{n}"] ** 2 for w, n in zip(weights, names, strict=True) if w), ca.SX(0))

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the weights against the controls."""
        if not dynamics.controls:
            raise InputError("TorqueRate() needs controls, but the phase has none.")
        weights_of(self.weights, [c.name.removeprefix("tau.") for c in dynamics.controls], "TorqueRate")

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Make the controls states."""
        return with_control_rates(dynamics)


@dataclass(frozen=True)
class Jerk(Integral):
    """Integral over the phase of sum_j w_j (d a_j / dt)^2 [rad^2/s^5, m^2/s^5], of a robot.

    With a motor at every joint, accelerations become states and the jerks controls. Otherwise torques become states,
    as for ``TorqueRate``, and the jerks follow from the time derivative of the torque balance.
    ``rt.constraints.JointJerk`` bounds them.

    Parameters
    ----------
    weights : None, number, sequence or mapping by joint
        One weight per moving joint, 1 by default.
    """

    weights: WeightsLike = None

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared jerks."""
        joints = [name.removeprefix("jerk.") for name in point.extra if name.startswith("jerk.")]
        weights = weights_of(self.weights, joints, "Jerk")
        return sum((w * point.extra[f"jerk.{j}"] ** 2 for w, j in zip(weights, joints, strict=True) if w), ca.SX(0))

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check that there is a robot without contacts, and the weights against its joints."""
        weights_of(self.weights, robot_of(dynamics, "Jerk").velocity_names, "Jerk")
        held = getattr(body_of(dynamics), "contacts", ())
        if held:
            raise InputError(
                f"Jerk() needs the rates of contact forces, which a phase with contact {held[0].name!r} does not have; "
                "use rt.objectives.TorqueRate(), or rt.objectives.FrameSmoothness for some frames."
            )

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the jerks."""
        return with_jerks(dynamics)
