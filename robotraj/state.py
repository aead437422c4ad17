"""The state at an end of a phase: free, fixed or bounded, by joint or state name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robotraj.constraints import Bounds, as_bounds
from robotraj.dynamics import Dynamics, RigidBody
from robotraj.errors import InputError
from robotraj.objectives import body_of


@dataclass(frozen=True)
class State:
    """Where a phase starts or ends.

    Parameters
    ----------
    values : mapping or sequence, optional
        For a System: values by state name, or one value per state.
    q, v : None, number, Between, sequence or mapping by joint name, optional
        For a robot: joint positions [rad, m] and velocities [rad/s, m/s].

    None leaves a value free, a number fixes it, ``rt.between(lower, upper)`` bounds it; joints that a mapping does not
    name stay free.
    """

    values: Mapping[str, Any] | Sequence[Any] | None = None
    q: Any = None
    v: Any = None

    def bounds(self, dynamics: Dynamics, which: str) -> Bounds:
        """Bounds on the state vector, (nx,) each; ``which`` is ``"start"`` or ``"end"``, for messages.

        States that an objective added stay free.

        Raises
        ------
        InputError
            Unknown names, wrong lengths, NaN, or q and v for a System.
        """
        body = body_of(dynamics)
        given = self._bounds(body, which)
        added = np.full(len(dynamics.states) - len(body.states), np.inf)
        return Bounds(np.append(given.lower, -added), np.append(given.upper, added))

    def _bounds(self, dynamics: Dynamics, which: str) -> Bounds:
        if isinstance(dynamics, RigidBody):
            if self.values is not None:
                raise InputError(
                    f"The {which} of a robot is rt.State(q=..., v=...); positional values are for Systems."
                )
            joints = dynamics.robot.joint_names
            q = as_bounds(self.q, joints, f"{which} position")
            v = as_bounds(self.v, joints, f"{which} velocity")
            return Bounds(np.concatenate([q.lower, v.lower]), np.concatenate([q.upper, v.upper]))
        if self.q is not None or self.v is not None:
            raise InputError(f"The {which} of a System is rt.State({{name: value}}); q= and v= are for robots.")
        return as_bounds(self.values, [s.name for s in dynamics.states], f"{which} state", "state")
