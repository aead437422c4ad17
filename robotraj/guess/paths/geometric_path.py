"""A path among obstacles as the guess of a phase."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import joint_motion
from robotraj.guess.least_time import LineLimits
from robotraj.guess.paths.path_in_time import TimedMotion, in_time
from robotraj.guess.paths.phase_scene import scene_of
from robotraj.guess.paths.planner import PathPlanner, RRTConnect
from robotraj.guess.paths.scene import PathScene
from robotraj.guess.paths.timed_path import timed_path
from robotraj.guess.perturbed import Perturbed
from robotraj.guess.straight_line import StraightLine
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem

_KNOWN: WeakKeyDictionary[Phase, dict[tuple[object, ...], list[TimedMotion]]] = WeakKeyDictionary()
"""Paths that were found for a phase, the quickest first."""


@dataclass(frozen=True)
class GeometricPath(InitialGuess):
    """The quickest of several paths around obstacles, from rest to rest.

    A geometric planner finds a path for each of several seeds. The limits of speed, acceleration and torque give every
    path a duration. Phases without ``rt.CollisionFree``, and those whose straight line is free, get that line.

    If obstacles move, the motion may wait or reverse on its path until they are gone (``guess.paths.path_in_time``).
    Further paths avoid the places of the obstacles at several times. If none is in time, a path avoids those at rest.

    Parameters
    ----------
    line : InitialGuess
        Determines the ends, and the guess of phases that need no path; a straight line by default.
    planner : PathPlanner
        ``rt.guess.RRTConnect()`` by default.
    tries : int
        Seeds, and paths that are compared.
    rank : int
        Rank of the path: 0 for the quickest, 1 for the next. If the straight line is free, further ranks are variations
        of it.
    starts : tuple of float
        Times at which the phases start [s], which ``prepared`` computes; phases without an entry start at 0.
    """

    line: InitialGuess = StraightLine()
    planner: PathPlanner = RRTConnect()
    tries: int = 3
    rank: int = 0
    starts: tuple[float, ...] = ()

    def prepared(self, problem: Problem) -> InitialGuess:
        """Compute the ends of the phases and, where obstacles move in a later phase, when the phases start."""
        ready, t = replace(self, line=self.line.prepared(problem), starts=()), 0.0
        last = max((i for i, phase in enumerate(problem.phases) if _moves(phase)), default=0)
        for index, phase in enumerate(problem.phases[:last]):
            t += ready.of(phase, index).duration
            ready = replace(ready, starts=(*(ready.starts or (0.0,)), t))
        return ready

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the path as a motion; a straight line where that is free, or where no path was found."""
        straight = self.line.of(phase, index)
        robot, scene, limits = phase.robot, scene_of(phase), LineLimits.of(phase)
        if robot is None or scene is None or limits is None:
            return straight
        first, last = self.ends(phase, index)
        t0 = self.starts[index] if index < len(self.starts) else 0.0
        paths = self._paths(phase, scene, limits, first, last, t0)
        if not paths:
            return straight if self.rank == 0 else Perturbed(self.line, self.rank).of(phase, index)
        path = paths[min(self.rank, len(paths) - 1)]
        duration = float(np.clip(path.duration, *phase.duration_bounds))

        def motion(s: Array) -> tuple[Array, Array, Array]:
            q, rate, second = path.motion(s)
            return q, rate / duration, second / duration**2

        return joint_motion(phase, duration, motion, default_parameters(phase))

    def is_closed(self, phase: Phase, index: int) -> bool:
        """Whether obstacles at rest block the straight line of a phase between free ends, and no path was found."""
        scene, limits = scene_of(phase), LineLimits.of(phase)
        if phase.robot is None or scene is None or limits is None:
            return False
        first, last = self.ends(phase, index)
        if scene.clearance(first, last) <= 0.0 or scene.is_free(first, last):
            return False
        return not self._paths(phase, replace(scene, moving=None), limits, first, last, 0.0)

    def ends(self, phase: Phase, index: int) -> tuple[Array, Array]:
        """Return the configurations (nq,) of a phase that moves a robot between which its motion is guessed."""
        assert phase.robot is not None
        first, last = self.line.of(phase, index).states(np.array([0.0, 1.0]))[:, : phase.robot.nq]
        return first, last

    def _paths(
        self, phase: Phase, scene: PathScene, limits: LineLimits, first: Array, last: Array, t0: float
    ) -> list[TimedMotion]:
        """Return the paths, the quickest first; none where the straight line is free or an end is not."""
        tries = max(self.tries, self.rank + 1)
        known = _KNOWN.setdefault(phase, {})
        key = (self.planner, tries, t0, scene.moving is None, first.tobytes(), last.tobytes())
        if key not in known:
            known[key] = []
            if scene.clearance(first, last) > 0.0:
                known[key] = sorted(self._found(phase, scene, limits, first, last, t0, tries), key=_seconds)
        return known[key]

    def _found(
        self, phase: Phase, scene: PathScene, limits: LineLimits, first: Array, last: Array, t0: float, tries: int
    ) -> list[TimedMotion]:
        is_free, moving = scene.is_free(first, last), scene.moving
        if is_free and moving is None:
            return []
        corners = [np.array([first, last])] if is_free else []
        if not is_free:
            corners += _planned(self.planner, scene, first, last, range(tries))
        paths = [path for path in (timed_path(limits, each) for each in corners) if path is not None]
        if moving is None:
            return list(paths)
        free = partial(moving.are_free, t0=t0, margin=scene.margin + moving.cushion(first, t0, scene.margin))
        bounds = phase.duration_bounds
        found = [path for path in (in_time(path, free, bounds) for path in paths) if path is not None]
        if is_free and found and found[0] is paths[0]:
            return []
        # Paths around the places of the obstacles during the quickest motion.
        within = min(path.duration for path in paths) if paths else 1.0
        frozen = replace(scene, tree=moving.frozen(scene.margin, t0, t0 + within, first, last))
        around = _planned(self.planner, frozen, first, last, range(tries)) if frozen.clearance(first, last) > 0 else []
        longer = [path for path in (timed_path(limits, each) for each in around) if path is not None]
        found += [path for path in (in_time(path, free, bounds) for path in longer) if path is not None]
        # Without one that avoids all, paths past the obstacles at rest are nearer to a motion than the straight line.
        return found or ([] if is_free else list(paths))


def _planned(planner: PathPlanner, scene: PathScene, first: Array, last: Array, seeds: Iterable[int]) -> list[Array]:
    """Return one path a seed, until a search finds none: others seldom find one then."""
    paths: list[Array] = []
    for seed in seeds:
        path = planner.path(scene, first, last, seed)
        if path is None:
            break
        paths.append(path)
    return paths


def _moves(phase: Phase) -> bool:
    scene = scene_of(phase)
    return scene is not None and scene.moving is not None


def _seconds(path: TimedMotion) -> float:
    return path.duration
