"""The interface of geometric planners, and the one that is built in."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.guess.paths.scene import PathScene


class PathPlanner(OneLine, ABC):
    """Finds paths without times. A new planner is one frozen dataclass that defines ``path``."""

    @abstractmethod
    def path(self, scene: PathScene, start: Array, end: Array, seed: int) -> Array | None:
        """Return the corners of a path of straight motions.

        Parameters
        ----------
        scene : PathScene
            Distances to obstacles, and whether straight motions are free.
        start, end : ndarray (nq,)
            Configurations that are free of collisions.
        seed : int
            Seed of the random numbers; equal seeds give equal paths.

        Returns
        -------
        ndarray (m, nq) or None
            With both ends; None if no path was found.
        """


@dataclass(frozen=True)
class RRTConnect(PathPlanner):
    """Trees of straight motions that grow from both ends until they meet; then random shortcuts.

    Every motion is proved to be free (``robotraj/native/src/collision/polynomial_motion.hpp``).
    Sources: Kuffner and LaValle, RRT-Connect, ICRA 2000; Geraerts and Overmars, Creating High-quality Paths for Motion
    Planning, IJRR 26 (2007).

    Parameters
    ----------
    stride : float
        Longest motion of one step [rad, m], the root of a sum of squares over the joints.
    iterations : int
        Largest number of random configurations.
    seconds : float
        Time limit [s]. If it ends the search, results depend on the machine.
    shortcuts : int
        Number of shortcuts that are tried.
    """

    stride: float = 1.0
    iterations: int = 50_000
    seconds: float = 5.0
    shortcuts: int = 100

    def path(self, scene: PathScene, start: Array, end: Array, seed: int) -> Array | None:
        """Return the corners of a shortened path."""
        weights = scene.speeds / scene.speeds.mean()
        lower, upper = _finite(scene.lower, start, end, -np.pi), _finite(scene.upper, start, end, np.pi)
        distances = scene.margin, scene.resolution(start, end)
        limits = self.stride, seed, self.iterations, self.seconds, self.shortcuts
        found = scene.tree.connect(start, end, lower, upper, weights, *limits, *distances)
        return found.reshape(-1, len(start)) if found.size else None


def _finite(bounds: Array, start: Array, end: Array, beyond: float) -> Array:
    """Return bounds for random configurations; joints without limits extend half a turn beyond the ends."""
    outermost = (np.maximum if beyond > 0 else np.minimum)(start, end)
    return np.asarray(np.where(np.isfinite(bounds), bounds, outermost + beyond))
