"""The motion of a foot: at its footholds, and on arcs between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.guess.legs.schedule import StanceTime


@dataclass(frozen=True, eq=False)
class Swing:
    """The stances of a foot and their footholds.

    Attributes
    ----------
    stands : sequence of StanceTime
        In the order of time.
    footholds : sequence of mapping of str to float
        Anchors of every stance.
    """

    stands: Sequence[StanceTime]
    footholds: Sequence[Mapping[str, float]]

    def at(self, t: float) -> dict[str, float]:
        """Return the anchors at a time [s], between stances on a minimum-jerk motion from rest to rest."""
        before, after, share = self._between(t)
        ease = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        first, last = self.footholds[before], self.footholds[after]
        return {name: value + ease * (last[name] - value) for name, value in first.items()}

    def lift(self, t: float) -> float:
        """Return the height above the ground divided by the apex: (4 s (1 - s))^2, s the fraction of the swing."""
        _, _, share = self._between(t)
        return (4.0 * share * (1.0 - share)) ** 2

    def _between(self, t: float) -> tuple[int, int, float]:
        """Return the indices of the stances before and after a time, and the fraction of the swing between them."""
        after = next((i for i, s in enumerate(self.stands) if t <= s.end), len(self.stands) - 1)
        begin = self.stands[after].start
        if t >= begin or after == 0:
            return after, after, 0.0
        left = self.stands[after - 1].end
        return after - 1, after, float(np.clip((t - left) / (begin - left), 0.0, 1.0))


def swings(
    contact: BoundContact,
    stands: Sequence[StanceTime],
    footholds: Sequence[Mapping[str, float]],
    home: Mapping[str, float],
) -> Swing:
    """Return the motion of a foot; a foot without stances keeps its anchors ``home``."""
    if stands:
        return Swing(stands, footholds)
    kept = {anchor.name: home[anchor.name] for anchor in contact.anchors}
    return Swing((StanceTime(contact.name, -np.inf, np.inf),), (kept,))
