"""What a plan says at one time, or at many."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj.dynamics import Named

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sample:
    """Values of a trajectory at a time (shape (n,)) or at m times (shape (m, n)).

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    x, z, u : Named
        States, algebraic variables and controls by name, each a float or (m,).
    q, v, a : ndarray or None
        Joint positions, velocities and accelerations of a robot, (nv,) or (m, nv).
    tau : ndarray or None
        Torques of the actuated joints, (nu,) or (m, nu) [N m, N].
    forces : Named
        Contact forces by contact name [N].
    """

    t: Any
    x: Named
    z: Named
    u: Named
    q: Array | None = None
    v: Array | None = None
    a: Array | None = None
    tau: Array | None = None
    forces: Named = field(default_factory=lambda: Named("contact", (), ()))


def join(samples: list[Sample], order: NDArray[np.int_]) -> Sample:
    """Stack samples of array times of the same dynamics, then reorder them."""

    def stack(parts: list[Any]) -> Any:
        return None if parts[0] is None else np.concatenate(parts)[order]

    def stack_named(parts: list[Named]) -> Named:
        names = list(parts[0])
        return Named(parts[0].kind, names, [stack([part[name] for part in parts]) for name in names])

    x, z, u = (stack_named([getattr(s, key) for s in samples]) for key in ("x", "z", "u"))
    vectors = {key: stack([getattr(s, key) for s in samples]) for key in ("q", "v", "a", "tau")}
    return Sample(stack([s.t for s in samples]), x, z, u, **vectors)
