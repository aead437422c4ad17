"""Mechanical work and absolute power: integrals of absolute values, exact by slacks or smoothed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import Slacks, body_of, free_of, has
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class MechanicalWork(Integral):
    """Integral over the phase of sum_j w_j (max(P_j, 0) + braking max(-P_j, 0)) with P_j = tau_j v_j [J].

    The exact form has one slack s_j >= 0 per joint with P_j + s_j >= 0, and integrates P_j + (1 + braking) s_j. At the
    optimum s_j = max(-P_j, 0) at every collocation point. This form eliminates s+ from the pair s+, s- >= 0 with
    P = s+ - s- and cost s+ + braking s-.

    The smooth form has sqrt(P^2 + e^2) - e in place of |P| = max(P, 0) + max(-P, 0), which is smaller by at most e. Its
    optimum is below the exact one by at most e T sum_j w_j (1 + braking) / 2.

    Where goals are to be proved and an arm's work is a small share of the objective, the program minimises the smooth
    form instead. Its e follows from the goal of the objective, and leaves out about a tenth of that.
    ``solution.objective`` is the exact form nevertheless.

    Only powers at collocation points count. A torque with a free mid-point can oscillate between them, and the optimum
    of a coarse mesh exploits this. Torques that are linear between knots cannot, and the default call plans arms with
    these. On a mesh of your own, use ``rt.HermiteSimpson(control=rt.schemes.LinearControl())``, which a moving mesh
    requires, or give ``tolerance=``. ``solution.objective`` has the least slacks at the points, and
    ``solution.proof.quadrature`` is its error between them. To check another plan, integrate |tau v| on a dense grid.

    Sources: Srinivasan and Ruina, Nature 439 (2006), for the objective; Betts, Practical Methods for Optimal
    Control (2010), section 1.16, for slacks in place of absolute values.

    Parameters
    ----------
    weights : None, number, sequence or mapping by joint
        One weight per actuated joint (per control of ``speeds``), 1 by default.
    braking : float
        Cost of a joule of braking, above -1. 0 counts positive work alone, 1 the absolute power; a negative cost
        rewards recuperation.
    smoothing : float, optional
        e > 0 [W]; None selects the exact form.
    speeds : mapping of str to str, optional
        For a System, the state that is the speed of each control: ``{"F": "v"}`` has the power F v.
    """

    weights: WeightsLike = None
    braking: float = 0.0
    smoothing: float | None = None
    speeds: Mapping[str, str] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (is_number(self.braking) and -1.0 < self.braking < np.inf):
            raise InputError(f"MechanicalWork: braking is {self.braking!r}; it must be a number above -1.")
        if self.smoothing is not None and not (is_number(self.smoothing) and 0.0 < self.smoothing < np.inf):
            raise InputError(f"MechanicalWork: smoothing is {self.smoothing!r}; it must be a power above 0 W, or None.")

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted cost of the powers [W]."""
        return self._rate(point, lambda control, power: point.extra[_slack(control)])

    def rate_of_motion(self, point: RobotPoint) -> Scalar:
        """Weighted cost of the powers, each slack with its least value max(-P, 0) [W]."""
        return self._rate(point, lambda control, power: ca.fmax(-power, 0.0))

    def _rate(self, point: RobotPoint, slack: Callable[[str, Scalar], Scalar]) -> Scalar:
        total = ca.SX(0)
        for weight, (control, speed) in self._weighed(tuple(point.u)):
            power = point.u[control] * point.x[speed]
            if self.smoothing is None:
                total += weight * (power + (1.0 + self.braking) * slack(control, power))
            else:
                size = ca.sqrt(power**2 + self.smoothing**2) - self.smoothing
                total += 0.5 * weight * ((1.0 + self.braking) * size + (1.0 - self.braking) * power)
        return total

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check weights and speeds against the controls and states."""
        if self.speeds is None and not isinstance(dynamics, RigidBody):
            raise InputError('MechanicalWork of a System needs speeds=, such as {"F": "v"} for the power F v.')
        for kind, given, known in (
            ("control", self.speeds or {}, dynamics.controls),
            ("state", (self.speeds or {}).values(), dynamics.states),
        ):
            names = [v.name for v in known]
            for name in given:
                if name not in names:
                    raise unknown_name(kind, name, names, "MechanicalWork(speeds=...) pairs controls with states.")
        self._weighed([c.name for c in dynamics.controls])

    def softened(self, dynamics: Dynamics, error: float) -> Integral:
        """Return the work whose program has the smooth form, of e = 2 error / (sum_j w_j (1 + braking))."""
        weights = [weight for weight, _ in self._weighed([c.name for c in free_of(body_of(dynamics)).controls])]
        if self.smoothing is not None or not weights:
            return self
        power = 2.0 * error / (sum(map(abs, weights)) * (1.0 + self.braking))
        return SoftWork(self.weights, self.braking, power, self.speeds)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add a slack per power, for the exact form."""
        body = free_of(body_of(dynamics))
        pairs = self._weighed([c.name for c in body.controls])
        joints = {c.name: c.joint for c in body.controls}
        slacks = tuple(
            Variable(_slack(c), "W", "slack power", joints[c]) for _, (c, _) in pairs if not has(dynamics, [_slack(c)])
        )
        return dynamics if self.smoothing is not None or not slacks else Slacks(dynamics, slacks)

    def definitions(self, dynamics: Dynamics) -> tuple[BoundConstraint, ...]:
        """s_j >= 0 and P_j + s_j >= 0, for the exact form."""
        if self.smoothing is not None:
            return ()
        return tuple(
            _define(control, speed)
            for _, (control, speed) in self._weighed([c.name for c in free_of(body_of(dynamics)).controls])
        )

    def _weighed(self, controls: Sequence[str]) -> list[tuple[float, tuple[str, str]]]:
        """Weights that are not zero, with the control and the speed of each power."""
        speeds = self.speeds or {c: f"v.{c.removeprefix('tau.')}" for c in controls}
        joints = [c.removeprefix("tau.") for c in speeds]
        pairs = zip(weights_of(self.weights, joints, "MechanicalWork"), speeds.items(), strict=True)
        return [(weight, pair) for weight, pair in pairs if weight != 0.0]


@dataclass(frozen=True)
class AbsolutePower(MechanicalWork):
    """Integral over the phase of sum_j w_j |tau_j v_j| [J]: mechanical work in which braking costs as much.

    Parameters are those of ``MechanicalWork``. The smooth form is below the exact one by at most e T sum_j w_j.
    """

    braking: float = 1.0


@dataclass(frozen=True)
class SoftWork(MechanicalWork):
    """The exact mechanical work of a motion, in a program that minimises its smooth form.

    Plans whose goals cannot see the difference have it in place of a work of small share.
    """

    def rate_of_motion(self, point: RobotPoint) -> Scalar:
        """Weighted cost of the powers, in the exact form [W]."""
        return MechanicalWork(self.weights, self.braking, None, self.speeds).rate_of_motion(point)

    def softened(self, dynamics: Dynamics, error: float) -> Integral:
        """Return itself."""
        return self


def _slack(control: str) -> str:
    return f"slack.{control}"


def _define(control: str, speed: str) -> BoundConstraint:
    name = f"slack power of {control.removeprefix('tau.')}"
    rows = (
        Row(name, "W", 0.0, np.inf, None, _slack(control)),
        Row(f"{name} plus power", "W", 0.0, np.inf),
    )

    def expression(point: RobotPoint) -> list[Scalar]:
        slack = point.extra[_slack(control)]
        return [slack, point.u[control] * point.x[speed] + slack]

    return BoundConstraint(name, rows, expression, Where.AT_NODES)
