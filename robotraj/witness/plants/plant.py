"""The protocol of a plant: a robot or a System under planned controls, as it is simulated."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.witness.protocols import Settle

RATE_UNITS = {"rad": "rad/s", "m": "m/s"}


@dataclass(frozen=True)
class Landing(OneLine):
    """Place at which a simulation set a contact down.

    Attributes
    ----------
    contact, phase : str
    time : float
        Start of the phase [s].
    distance : float
        Distance from the planned place [m].
    moved : float
        Largest distance from its place while the contact held in the simulation [m, rad].
    """

    contact: str
    phase: str
    time: float
    distance: float
    moved: float = 0.0


class Plant(Protocol):
    """The states x of a phase and their rates under the planned controls.

    Attributes
    ----------
    names : tuple of str
        Names of the states, (n,).
    gap_names, gap_units : tuple of str
        Names and units of the difference of two states, (k,). The orientation of a floating root differs by a vector of
        three angles.
    """

    names: tuple[str, ...]
    gap_names: tuple[str, ...]
    gap_units: tuple[str, ...]

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Return the planned states (m, n) at times (m,)."""
        ...

    def gaps(self, states: Array, planned: Array) -> Array:
        """Return the differences (m, k) of states (m, n) from planned states (m, n)."""
        ...

    def coordinates(self, states: Array) -> Array:
        """Return coordinates (m, k) of states (m, n), whose range is that of the differences of states."""
        ...

    def spread(self, sizes: Array) -> Array:
        """Return the sizes of the entries of a state (n,) for sizes of the differences of states (k,)."""
        ...

    def given(self, times: Array) -> Array:
        """Return the planned controls and other planned arguments of ``rate`` at times (m,), one row each."""
        ...

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Return the rate (n,) of a state."""
        ...

    def jacobian(self, t: float, x: Array, given: Array) -> Array:
        """Return the derivative (n, n) of ``rate`` with respect to x."""
        ...

    @property
    def settle(self) -> Settle | None:
        """Projection of a state on the constraints that hold; None without any."""
        ...

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Set the contacts down at a state x; return the state after their impact and the places."""
        ...

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Add the distances that the contacts moved in simulated states (m, n)."""
        ...
