"""Squared torques, integrated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj.errors import InputError, unknown_name
from robotraj.objectives.base import Integral

if TYPE_CHECKING:
    from robotraj.dynamics.dae import Dynamics


@dataclass(frozen=True)
class Effort(Integral):
    """Integral over the phase of sum_j w_j tau_j^2, without a half [N^2 m^2 s].

    Parameters
    ----------
    weights : None, sequence or mapping by joint
        One weight per actuated joint (per control of a System); None weighs all with 1, joints that a mapping does
        not name weigh 0.
    """

    weights: Any = None

    def rate(self, point: Any) -> Any:
        """Weighted sum of squared controls."""
        names = list(point.u)
        weights = self._resolved(names)
        return sum((w * point.u[name] ** 2 for w, name in zip(weights, names, strict=True) if w != 0.0), 0.0)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the weights against the controls."""
        if not dynamics.controls:
            raise InputError("Effort() needs controls, but the phase has none.")
        self._resolved([c.name for c in dynamics.controls])

    def _resolved(self, names: Sequence[str]) -> list[float]:
        if self.weights is None:
            return [1.0] * len(names)
        # Controls of robots are called tau.<joint>; users weigh them by joint.
        joints = [name.removeprefix("tau.") for name in names]
        if isinstance(self.weights, Mapping):
            for key in self.weights:
                if key not in joints:
                    raise unknown_name("actuated joint", key, joints, "Effort(weights=...) names actuated joints.")
            given = [float(self.weights.get(joint, 0.0)) for joint in joints]
        else:
            given = [float(w) for w in np.asarray(self.weights, dtype=float).ravel()]
            given = given * len(names) if len(given) == 1 else given
        if len(given) != len(names):
            raise InputError(f"Effort has {len(given)} weights for {len(names)} controls: {', '.join(joints)}.")
        for joint, weight in zip(joints, given, strict=True):
            if not weight >= 0 or np.isinf(weight):
                raise InputError(f"Effort: the weight of {joint!r} is {weight}; it must be finite and not negative.")
        return given
