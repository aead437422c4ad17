"""A path among obstacles as the guess of a phase."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.guess.base import InitialGuess, PhaseGuess
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import joint_motion
from robotraj.guess.least_time import LineLimits
from robotraj.guess.paths.phase_scene import scene_of
from robotraj.guess.paths.planner import PathPlanner, RRTConnect
from robotraj.guess.paths.scene import PathScene
from robotraj.guess.paths.timed_path import TimedPath, timed_path
from robotraj.guess.perturbed import Perturbed
from robotraj.guess.straight_line import StraightLine

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem

Array = NDArray[np.float64]

_KNOWN: WeakKeyDictionary[Phase, dict[tuple[object, ...], list[TimedPath]]] = WeakKeyDictionary()
"""Paths that were found for a phase, the quickest first."""


@dataclass(frozen=True)
class GeometricPath(InitialGuess):
    """The quickest of several paths around obstacles, from rest to rest.

    A geometric planner finds a path for each of several seeds. The limits of speed, acceleration and torque give every
    path a duration. Phases without ``rt.CollisionFree``, and those whose straight line is free, get that line.

    Parameters
    ----------
    line : InitialGuess
        Determines the ends, and the guess of phases that need no path; a straight line by default.
    planner : PathPlanner
        ``rt.guess.RRTConnect()`` by default.
    tries : int
        Seeds, and paths that are compared.
    rank : int
        Which path is taken: 0 for the quickest, 1 for the next. Further ranks are other starts; where the straight
        line is free, they are variations of it.
    """

    line: InitialGuess = StraightLine()
    planner: PathPlanner = RRTConnect()
    tries: int = 3
    rank: int = 0

    def prepared(self, problem: Problem) -> InitialGuess:
        """Compute the ends of the phases."""
        return replace(self, line=self.line.prepared(problem))

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the path as a motion; a straight line where that is free, or where no path was found."""
        straight = self.line.of(phase, index)
        robot, scene, limits = phase.robot, scene_of(phase), LineLimits.of(phase)
        if robot is None or scene is None or limits is None:
            return straight
        first, last = straight.states(np.array([0.0, 1.0]))[:, : robot.nq]
        paths = self._paths(phase, scene, limits, first, last)
        if not paths:
            return straight if self.rank == 0 else Perturbed(self.line, self.rank).of(phase, index)
        path = paths[min(self.rank, len(paths) - 1)]
        duration = float(np.clip(path.duration, *phase.duration_bounds))

        def motion(s: Array) -> tuple[Array, Array, Array]:
            q, rate, second = path.motion(s)
            return q, rate / duration, second / duration**2

        return joint_motion(phase, duration, motion, default_parameters(phase))

    def _paths(self, phase: Phase, scene: PathScene, limits: LineLimits, first: Array, last: Array) -> list[TimedPath]:
        """Return the paths, the quickest first; none where the straight line is free or an end is not."""
        tries = max(self.tries, self.rank + 1)
        known = _KNOWN.setdefault(phase, {})
        key = (self.planner, tries, first.tobytes(), last.tobytes())
        if key not in known:
            known[key] = []
            if scene.clearance(first, last) > 0.0 and not scene.is_free(first, last):
                corners = (self.planner.path(scene, first, last, seed) for seed in range(tries))
                timed = (timed_path(limits, path) for path in corners if path is not None)
                found = (path for path in timed if path is not None)
                known[key] = sorted(found, key=lambda path: path.duration)
        return known[key]
