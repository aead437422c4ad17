"""The coordinates of a robot's root: fixed, planar or floating."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.witness.mujoco.coordinates import rotation

QUATERNION = slice(3, 7)
"""Entries of the quaternion of a floating root in q."""

PLANAR = ["root_x", "root_z", "root_pitch"]


class RootCoordinates:
    """The coordinates of a root that is fixed, planar (x, z and pitch first) or floating.

    Parameters
    ----------
    model : pinocchio.Model

    Attributes
    ----------
    floating, moves : bool
    turns : slice
        Angular velocities of the root in v; empty for a fixed root.
    """

    def __init__(self, model: pin.Model) -> None:
        self._nv = int(model.nv)
        self.floating = bool(model.nq > model.nv)
        self.moves = self.floating or list(model.names)[1:4] == PLANAR
        self.turns = slice(3, 6) if self.floating else slice(2, 3) if self.moves else slice(0, 0)

    def moved(self, q: Array, shift: Array) -> Array:
        """Return positions (..., nq) shifted by (3,) along world axes [m]; a planar root stays in its plane."""
        there = np.array(q)
        if self.floating:
            there[..., :3] += shift
        elif self.moves:
            there[..., :2] += shift[[0, 2]]
        return there

    def along(self, q: Array) -> Array:
        """Return velocities (nv, 3) that move the robot along world axes."""
        found = np.zeros((self._nv, 3))
        if self.floating:
            found[:3] = rotation(q[QUATERNION]).T
        elif self.moves:
            found[0, 0] = found[1, 2] = 1.0
        return found

    def upright(self, q: Array, gap: Array) -> Array:
        """Return a deviation (2 nv,) from q with the shift of a floating root along world axes, not its own."""
        shown = np.array(gap)
        if self.floating:
            shown[:3] = rotation(q[QUATERNION]) @ shown[:3]
        return shown
