"""Rows that keep the links of a robot apart along a known free motion, from one solve to the next.

Pairs of links that nearly touch along the motion have rows from the first solve on. Pairs that overlap along a solution
have some in the next one. All rows are fixed along the known motion, which meets them.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.clearance.own_shapes import MARGIN, least_at_ends, own_shapes
from robotraj.problem.phase import Phase
from robotraj.robot.collision.along_motion import Motion, pairs_along
from robotraj.transcription.clearance.supporting_planes import motion_of
from robotraj.transcription.clearance.surface_rows import FRACTIONS, NearPair, NearSurfaces


class LinksAlong:
    """The pairs of links with rows in one phase.

    There are none without shapes, and none on a path, where no row can move the links.

    Parameters
    ----------
    phase : Phase
    known : PiecewisePolynomial
        The free motion, whose states in time begin with the positions.
    """

    def __init__(self, phase: Phase, known: PiecewisePolynomial) -> None:
        self._phase, self._known = phase, known
        self._body = None if phase.path is not None else own_shapes(phase)
        self._rows: dict[int, NearPair] = {}
        # Links at twice the margin of rows count as kept apart by them.
        touching = self._within(known, 2.0 * MARGIN)
        overlapping = self._within(known, 0.0) if touching else []
        self._include([pair for pair in touching if pair not in overlapping])

    @property
    def surfaces(self) -> NearSurfaces | None:
        """The rows of all pairs."""
        if not self._rows:
            return None
        assert self._phase.robot is not None and self._body is not None
        return NearSurfaces(self._phase.robot, self._body, tuple(self._rows.values()))

    def add(self, found: PiecewisePolynomial) -> bool:
        """Add rows of pairs that overlap along another motion, and return whether there are new ones."""
        new = [pair for pair in self._within(found, 0.0) if pair not in self._rows]
        self._include(new)
        return bool(new)

    def _include(self, pairs: list[int]) -> None:
        if self._body is None or not pairs:
            return
        q = self._positions(self._known)(FRACTIONS)
        for pair in pairs:
            self._rows[pair] = NearPair(pair, q, MARGIN, least_at_ends(self._phase, self._body, pair), np.inf)

    def _within(self, motion: PiecewisePolynomial, margin: float) -> list[int]:
        """Return the pairs that come within a margin [m] at equal steps of a motion."""
        if self._phase.robot is None or self._body is None:
            return []
        return pairs_along(self._phase.robot, self._body, self._positions(motion), margin)

    def _positions(self, motion: PiecewisePolynomial) -> Motion:
        assert self._phase.robot is not None
        positions = motion_of(motion, self._phase.robot.nq)
        return lambda fractions: positions(fractions)[0]
