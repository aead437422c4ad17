"""Values of a plan at one time, or at several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, NoSuchValue, no_attribute, no_entry
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Named

JOINTS = ("q", "v", "a", "tau")
"""Names of what a sample has of a robot's joints."""
Value = TypeVar("Value", bound="float | Array", covariant=True)
"""What a sample has of each variable: a float at one time, an array at several."""
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
class Sample(OneLine, Generic[Value]):
    """Values of a trajectory at a time (shape (n,)) or at m times (shape (m, n)).

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    x, z, u : Named
        States, algebraic variables and controls by name, each a float or (m,).
    forces : Named
        Contact forces by contact name, (3,) or (m, 3) [N], with moments (6,) or (m, 6) [N, N m]; world axes. Zero where
        a contact of the plan is not held.
    q, v, a, tau : ndarray
        Those of ``JointSample``. Where the plan moves a ``System``, an error names its variables.
    """

    t: Value
    x: Named[Value]
    z: Named[Value]
    u: Named[Value]
    forces: Named[Array]

    if TYPE_CHECKING:
        # Type checkers cannot know which kind a plan returns.
        @property
        def q(self) -> Array: ...  # noqa: D102, as of JointSample

        @property
        def v(self) -> Array: ...  # noqa: D102, as of JointSample

        @property
        def a(self) -> Array: ...  # noqa: D102, as of JointSample

        @property
        def tau(self) -> Array: ...  # noqa: D102, as of JointSample

    else:

        def __getattr__(self, name: str) -> object:
            # A sample that is being unpickled has no fields yet.
            if name not in JOINTS or "x" not in vars(self):
                raise no_attribute(self, name)
            kinds = (("x", self.x), ("u", self.u))
            lists = (f"{kind}[{', '.join(map(repr, names))}]" for kind, names in kinds if names)
            raise NoSuchValue(
                f"The sample of a System has no {name!r}, which is that of a robot's joints. "
                f"Read its variables by name: sample.{', sample.'.join(lists)}."
            )

        def __getitem__(self, name: object) -> object:
            raise no_entry(self, name)

    def with_contacts(self, sizes: Mapping[str, int]) -> Sample[Value]:
        """Add contacts that are not held, with zero force; ``sizes`` gives the components of each."""
        if set(sizes) <= set(self.forces):
            return self
        shape = np.shape(self.t)
        held = {name: self.forces[name] if name in self.forces else np.zeros((*shape, n)) for name, n in sizes.items()}
        return replace(self, forces=Named("contact", list(held), list(held.values())))


@dataclass(frozen=True, eq=False)
class JointSample(Sample[Value]):
    """A sample of a plan that moves a robot.

    Attributes
    ----------
    q : ndarray
        Positions, (nq,) or (m, nq) [rad, m]; quaternions have length 1.
    v, a : ndarray
        Velocities and accelerations, (nv,) or (m, nv) [rad/s, m/s; rad/s^2, m/s^2].
    tau : ndarray
        Torques of the actuated joints, (nu,) or (m, nu) [N m, N].
    """

    q: Array
    v: Array
    a: Array
    tau: Array


def no_forces() -> Named[Array]:
    """Return the forces of a plan without contacts."""
    return Named("contact", (), ())


def join(samples: Sequence[Sample[Array]], order: NDArray[np.int_]) -> Sample[Array]:
    """Stack samples of array times, then reorder them; of named variables, those that all of them have."""

    def stack(parts: Sequence[float | Array]) -> Array:
        return np.concatenate([np.asarray(part) for part in parts])[order]

    def stack_named(parts: Sequence[Named[float | Array]]) -> Named[Array]:
        names = [name for name in parts[0] if all(name in part for part in parts)]
        return Named(parts[0].kind, names, [stack([part[name] for part in parts]) for name in names])

    parts = (
        stack([s.t for s in samples]),
        stack_named([s.x for s in samples]),
        stack_named([s.z for s in samples]),
        stack_named([s.u for s in samples]),
        stack_named([s.forces for s in samples]),
    )
    moved = [s for s in samples if isinstance(s, JointSample)]
    return JointSample(*parts, *(stack([getattr(s, n) for s in moved]) for n in JOINTS)) if moved else Sample(*parts)
