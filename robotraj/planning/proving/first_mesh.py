"""First meshes of a plan whose mesh was left open, from the problem alone."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field, replace

import numpy as np

from robotraj._util.precision import SAME
from robotraj._util.values import dataclass
from robotraj.fixed_mesh.sizes.shares import shares_of
from robotraj.problem.problem import Problem
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.refinement.linear_controls import LINES
from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.lobatto import HermiteSimpson, LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.radau import RadauIIA

FEW = 16
"""Intervals of the first mesh. It approximates the motion, and objectives of finer meshes are compared with its own."""
SECOND = 3.0
"""Least growth to the second mesh, on which most objectives settle."""
COARSE, NEXT = 28, 2.5
"""Both for motions in least time, which converge by a lower order: from 16 and 48 intervals they needed a third mesh.

Where integrals and ends both count, the numbers lie between in proportion to their sizes."""
SYSTEM = 30
"""Intervals of the first mesh for systems and robots without a motor at every joint."""
UNREFINED = 20
"""Intervals where a tolerance is given, or no plan is proved."""
STEP = 4
"""Intervals of the longest phase of a motion with contacts, by Lobatto IIIA with four points."""
VALUES = 12 * 640
"""Values of the states on the finest mesh of a system: those of an arm of six joints on 640 intervals."""
CROWDING = 0.8
"""Concentration of the knots at the ends, from 0 for equal intervals to 1."""


STICKING = RadauIIA(3)
"""Scheme of motions with dry friction for the least integral.

A joint may start and stop inside every interval, and Simpson's rule has only its middle inside. The sum that is
minimised is then lower than the integral by percents. With one more point, and none shared, the two agree.
"""


class OfProblem(ABC):
    """A choice that depends on sizes of the problem."""

    @abstractmethod
    def of(self, problem: Problem) -> object:
        """Return the value of the setting."""


@dataclass(frozen=True)
class MeshOfShares(OfProblem):
    """A mesh of ``FEW`` intervals for integrals, and of up to ``COARSE`` where the ends count, as in least time."""

    def of(self, problem: Problem) -> Mesh:
        """Return the mesh of all phases."""
        return graded(round(FEW + (COARSE - FEW) * _ends(problem)))


@dataclass(frozen=True)
class RefinementOfShares(OfProblem):
    """Equidistribution that grows by ``SECOND`` to the second mesh for integrals, down to ``NEXT`` for the ends."""

    def of(self, problem: Problem) -> Equidistribute:
        """Return the refinement of all phases."""
        return Equidistribute(second=SECOND + (NEXT - SECOND) * _ends(problem))


@dataclass(frozen=True)
class RefinementOfStates(OfProblem):
    """Equidistribution whose finest mesh has ``VALUES`` values of the states, since small systems are solved quickly.

    A mesh of 640 intervals is never too fine: an oscillation of many periods needs a dozen intervals for each.
    """

    def of(self, problem: Problem) -> Equidistribute:
        """Return the refinement of all phases."""
        own = Equidistribute()
        states = max(1, *(len(phase.dae.states) for phase in problem.phases))
        return replace(own, finest=max(own.finest, VALUES // states))


def _ends(problem: Problem) -> float:
    """Part of the ends in the objective; none where obstacles are in the way, which decide a motion without a path."""
    free = [phase for phase in problem.phases if phase.path is None]
    avoiding = any(each.avoids_collisions for phase in free for each in phase.constraints)
    return 0.0 if avoiding else shares_of(problem).ends


@dataclass(frozen=True)
class ProportionalMeshes(OfProblem):
    """Meshes of several phases, with numbers of intervals in proportion to the durations.

    Attributes
    ----------
    most, least : int
        Numbers of intervals of the longest phase, and of the shortest ones.
    scheme : Scheme
        Scheme of all intervals.
    """

    most: int = STEP
    least: int = STEP // 2
    scheme: Scheme = field(default_factory=lambda: LobattoIIIA(4))

    def of(self, problem: Problem) -> tuple[Mesh, ...]:
        """Return the mesh of each phase; the length of a free duration is the middle of its bounds."""
        lengths = np.array([0.5 * sum(phase.duration_bounds) for phase in problem.phases])
        known = np.isfinite(lengths)
        # A phase of any duration counts as the longest.
        lengths = np.where(known, lengths, max(lengths[known], default=1.0))
        counts = np.clip(np.ceil(self.most * lengths / lengths.max() - SAME), self.least, self.most)
        return tuple(Mesh(int(count), self.scheme) for count in counts)


@dataclass(frozen=True)
class MeshesOnPaths(OfProblem):
    """Meshes of phases of which some are on a path: those on a path have lines.

    They have ``3 FEW`` intervals, since there are two states and one control. Rows are imposed at three points of such
    an interval, on which s'' is a line.
    """

    def of(self, problem: Problem) -> tuple[Mesh, ...]:
        """Return the mesh of each phase."""
        return tuple(graded(FEW) if phase.path is None else graded(3 * FEW, LINES) for phase in problem.phases)


@dataclass(frozen=True)
class MeshesOfLines(OfProblem):
    """Meshes of ``2 FEW`` intervals whose controls are lines, so that no power is hidden between the points."""

    intervals: int = 2 * FEW

    def of(self, problem: Problem) -> tuple[Mesh, ...]:
        """Return the mesh of each phase."""
        return (graded(self.intervals, LINES),) * len(problem.phases)


def graded(count: int, scheme: Scheme | None = None) -> Mesh:
    """Crowd intervals at both ends, where motions start and stop; Hermite-Simpson by default.

    The knots are (1 + (1 - c) x + c sin(pi x / 2)) / 2 at equally spaced x in [-1, 1]. Here c is ``CROWDING``.
    """
    x = np.linspace(-1.0, 1.0, count + 1)
    knots = 0.5 * (1.0 + (1.0 - CROWDING) * x + CROWDING * np.sin(0.5 * np.pi * x))
    knots[0], knots[-1] = 0.0, 1.0
    return Mesh(tuple(knots.tolist()), scheme or HermiteSimpson())
