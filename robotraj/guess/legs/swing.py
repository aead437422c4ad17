"""Where a foot is over time: on the ground, or on an arc from one foothold to the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.values import dataclass
from robotraj.guess.legs.schedule import Stand

if TYPE_CHECKING:
    from robotraj.dynamics.contacts.base import BoundContact


@dataclass(frozen=True, eq=False)
class Swing:
    """A foot's stances and the footholds of each.

    Attributes
    ----------
    stands : sequence of Stand
        In the order of time.
    spots : sequence of mapping of str to float
        Anchors of every stance.
    """

    stands: Sequence[Stand]
    spots: Sequence[Mapping[str, float]]

    def at(self, t: float) -> dict[str, float]:
        """Anchors at a time [s]; between stances they move without a jerk, from rest to rest."""
        before, after, share = self._between(t)
        ease = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        first, last = self.spots[before], self.spots[after]
        return {name: value + ease * (last[name] - value) for name, value in first.items()}

    def lift(self, t: float) -> float:
        """Height above the ground as a share of the apex: 16 s^2 (1 - s)^2 of the swing."""
        _, _, share = self._between(t)
        return 16.0 * share**2 * (1.0 - share) ** 2

    def _between(self, t: float) -> tuple[int, int, float]:
        """Stances before and after a time, and the share of the swing between them that is over."""
        after = next((i for i, s in enumerate(self.stands) if t <= s.end), len(self.stands) - 1)
        begin = self.stands[after].start
        if t >= begin or after == 0:
            return after, after, 0.0
        left = self.stands[after - 1].end
        return after - 1, after, float(np.clip((t - left) / (begin - left), 0.0, 1.0))


def swings(
    contact: BoundContact, stands: Sequence[Stand], spots: Sequence[Mapping[str, float]], home: Mapping[str, float]
) -> Swing:
    """Swing of a foot; one that never stands stays where it is at home."""
    if stands:
        return Swing(stands, spots)
    own = {anchor.name: home[anchor.name] for anchor in contact.anchors}
    return Swing((Stand(contact.name, -np.inf, np.inf),), (own,))
