"""Values of a plan at one time, or at several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Named

Array = NDArray[np.float64]
Times: TypeAlias = float | Sequence[float] | Array
"""One time [s], or several."""


def as_times(t: Times) -> Array:
    """Return one time or a vector of times as an array.

    Raises
    ------
    InputError
        They are no numbers or have several axes.
    """
    try:
        times = np.asarray(t, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"Times must be a number or a vector [s]; got {t!r}.") from error
    if times.ndim > 1:
        raise InputError(f"Times must be a number or a vector; got shape {times.shape}.")
    return times


@dataclass(frozen=True, eq=False)
class Sample(OneLine):
    """Values of a trajectory at a time (shape (n,)) or at m times (shape (m, n)).

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    x, z, u : Named
        States, algebraic variables and controls by name, each a float or (m,).
    q : ndarray or None
        Positions of a robot, (nq,) or (m, nq) [rad, m]; quaternions have length 1.
    v, a : ndarray or None
        Its velocities and accelerations, (nv,) or (m, nv) [rad/s, m/s; rad/s^2, m/s^2].
    tau : ndarray or None
        Torques of the actuated joints, (nu,) or (m, nu) [N m, N].
    forces : Named
        Contact forces by contact name, (3,) or (m, 3) [N], with moments (6,) or (m, 6) [N, N m]; world axes. Zero where
        a contact of the plan is not held.
    """

    t: float | Array
    x: Named[float | Array]
    z: Named[float | Array]
    u: Named[float | Array]
    q: Array | None = None
    v: Array | None = None
    a: Array | None = None
    tau: Array | None = None
    forces: Named[Array] = field(default_factory=lambda: Named("contact", (), ()))

    def with_contacts(self, sizes: Mapping[str, int]) -> Sample:
        """Add contacts that are not held, with zero force; ``sizes`` gives the components of each."""
        if set(sizes) <= set(self.forces):
            return self
        shape = np.shape(self.t)
        held = {name: self.forces[name] if name in self.forces else np.zeros((*shape, n)) for name, n in sizes.items()}
        return replace(self, forces=Named("contact", list(held), list(held.values())))


def join(samples: list[Sample], order: NDArray[np.int_]) -> Sample:
    """Stack samples of array times, then reorder them; of named variables, those that all of them have."""

    def stack(parts: Sequence[float | Array]) -> Array:
        return np.concatenate([np.asarray(part) for part in parts])[order]

    def stack_vectors(parts: Sequence[Array | None]) -> Array | None:
        known = [part for part in parts if part is not None]
        return stack(known) if known else None

    def stack_named(parts: Sequence[Named[float | Array]]) -> Named[Array]:
        names = [name for name in parts[0] if all(name in part for part in parts)]
        return Named(parts[0].kind, names, [stack([part[name] for part in parts]) for name in names])

    return Sample(
        stack([s.t for s in samples]),
        stack_named([s.x for s in samples]),
        stack_named([s.z for s in samples]),
        stack_named([s.u for s in samples]),
        stack_vectors([s.q for s in samples]),
        stack_vectors([s.v for s in samples]),
        stack_vectors([s.a for s in samples]),
        stack_vectors([s.tau for s in samples]),
        stack_named([s.forces for s in samples]),
    )
