"""The guess of a phase that follows a path: smooth timing from end to end, slow enough for speeds and torques."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.guess.base import Curve, InitialGuess, PhaseGuess
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import designed
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.path_parameter import ACCELERATION, PARAMETER, SPEED

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

PLACES = np.linspace(0.0, 1.0, 65)
"""Fractions of the motion at which speeds and torques are compared with their limits."""
LONGER, TRIES = 1.25, 20
"""Factor by which a duration grows while torques exceed their limits, and largest number of times."""


@dataclass(frozen=True)
class AlongPath(InitialGuess):
    """The path of ``rt.constraints.FollowPath`` with s = s_0 + (s_1 - s_0) (3 f^2 - 2 f^3) at the fraction f.

    The guessed duration keeps the limits of speed and, where possible, of torque.
    """

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the path."""
        path = next(each for each in phase.constraints if isinstance(each, FollowPath)).path
        bends = [path, path.derivative()]
        bends.append(bends[1].derivative())
        first, span = float(path.breaks[0]), float(path.breaks[-1] - path.breaks[0])
        robot = designed(phase, default_parameters(phase))
        model, data = robot.model, robot.model.createData()

        def motion(f: Array, duration: float) -> dict[str, Array]:
            f = np.asarray(f, dtype=float)
            s = first + span * f**2 * (3.0 - 2.0 * f)
            rate, bend = span * 6.0 * f * (1.0 - f) / duration, span * (6.0 - 12.0 * f) / duration**2
            q, slope, second = (curve(s) for curve in bends)
            v, a = slope * rate[:, None], slope * bend[:, None] + second * rate[:, None] ** 2
            forces = [pin.rnea(model, data, *row) + robot.dissipation(row[1]) for row in zip(q, v, a, strict=True)]
            kinds = {"q": (q, robot.position_names), "v": (v, robot.velocity_names), "a": (a, robot.velocity_names)}
            kinds["tau"] = np.array(forces) @ robot.actuation, robot.actuated
            named = {f"{kind}.{name}": t[:, i] for kind, (t, names) in kinds.items() for i, name in enumerate(names)}
            return named | {PARAMETER: s, SPEED: rate, ACCELERATION: bend}

        limits = phase.rows.limits()

        def excess(duration: float, kind: str) -> float:
            known = motion(PLACES, duration)
            ratios = [
                float(np.max(np.maximum(known[name] / high, known[name] / low)))
                for name, (low, high) in limits.items()
                if name.startswith(kind) and low < 0.0 < high
            ]
            return max(ratios, default=0.0)

        low, high = phase.duration_bounds
        duration = max(excess(1.0, "v."), 1e-2)
        for _ in range(TRIES):
            if excess(duration, "tau.") <= 1.0:
                break
            duration *= LONGER
        duration = float(np.clip(duration, low, high))

        def curve(variables: tuple[Variable, ...]) -> Curve:
            def values(f: Array) -> Array:
                known = motion(f, duration)
                zero = np.zeros(len(np.asarray(f)))
                return np.column_stack([known.get(v.name, zero) for v in variables] or [np.zeros((len(zero), 0))])

            return values

        dae = phase.dae
        return PhaseGuess(
            duration, curve(dae.states), curve(dae.algebraic), curve(dae.controls), default_parameters(phase)
        )


def follows_path(phase: Phase) -> bool:
    """Whether a phase has ``rt.constraints.FollowPath``."""
    return any(isinstance(each, FollowPath) for each in phase.constraints)
