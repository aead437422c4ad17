"""Refinement by equidistribution: the order of the scheme predicts the mesh that is needed.

The residual of s-point collocation on an interval of length h falls about as h^(s + 1). An interval of error e needs

    n = (e / (SAFETY tolerance))^(1 / (s + 1))

parts. Where a control jumps inside an interval its error falls as h, and the power is 1. The sum of n over an
interval's length is a density of knots; the next mesh has equal shares of it.

Where the required lengths h grow too fast along the phase, they are replaced by

    min over s of h(s) + slope |t - s|,

so that intervals are also short near events whose times change from mesh to mesh.
Sources: de Boor, Good approximation by splines with variable knots II, Lecture Notes in Mathematics 363 (1974);
Persson, Mesh size functions for implicit geometries and PDE-based gradient limiting, Eng. with Computers 22 (2006).
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.transcription.refinement.base import Assessment, Refinement, error_order
from robotraj.transcription.refinement.split_and_merge import SplitAndMerge
from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.mesh import Mesh

SAFETY = 0.25
"""Share of the tolerance that the next mesh should reach."""
STEEP = 6.0
"""Least change of a control that counts as a jump, relative to its range and to the length of the interval.

On few intervals a smooth control changes by as much in each of them.
"""
LEAST_GROWTH = 1.1
"""Least growth of the number of intervals; with less, the change of the objective would not be significant."""


@dataclass(frozen=True)
class Equidistribute(Refinement):
    """Place the knots so that every interval has the same share of the error.

    Parameters
    ----------
    most : float
        Largest number of parts of an interval at once, since errors of coarse meshes do not follow their order.
    second : float
        Least growth from the first mesh to the second, so that the change of the objective is significant.
    finest : int
        Largest number of intervals of a phase. A mesh of that many moves its knots to where errors are too large.
    path : float
        Relative violation of a path row between the collocation points beyond which an interval is divided.
    slope : float
        Most by which the length of intervals grows along the phase, relative to the distance.

    Raises
    ------
    InputError
        ``most`` is below 2, ``second`` not above 1, ``finest`` below 1, or ``slope`` not above 0.
    """

    most: float = 4.0
    second: float = 1.5
    finest: int = 640
    path: float = 1e-3
    slope: float = np.inf

    def __post_init__(self) -> None:
        if not (is_number(self.most) and self.most >= 2):
            raise InputError(f"Equidistribute(most) must be at least 2, got {self.most!r}.")
        if not (is_number(self.second) and self.second > 1):
            raise InputError(f"Equidistribute(second) must be above 1, got {self.second!r}.")
        if not (is_number(self.slope) and self.slope > 0):
            raise InputError(f"Equidistribute(slope) must be above 0, got {self.slope!r}.")
        if not (is_number(self.finest) and self.finest >= 1):
            raise InputError(f"Equidistribute(finest) must be at least 1, got {self.finest!r}.")

    def refine(self, mesh: Mesh, assessment: Assessment, tolerance: float) -> Mesh:
        """Return a mesh with ``assessment.growth`` times as many intervals everywhere, and more where errors are large.

        The same mesh is returned if all errors are below the tolerance and ``assessment.growth`` is 1.
        """
        orders = np.array([error_order(scheme) for scheme in mesh.schemes], dtype=float)
        orders[assessment.jumps > np.maximum(SplitAndMerge.jump, STEEP * np.diff(mesh.knots))] = 1.0
        parts = (assessment.errors / (SAFETY * tolerance)) ** (1.0 / orders)
        parts = np.where(assessment.errors > tolerance, np.maximum(parts, 1.0), 1.0)
        broken = np.append(0.0, np.append(assessment.broken, 0.0))
        beside = np.maximum(broken[1:-1], np.maximum(broken[:-2], broken[2:]))
        # The excess is taken to fall with the cube of the length, as the error of quadratic controls does. Knots change
        # with the number of intervals, so that a violation near an end may be in the next interval of the new mesh:
        # intervals beside it get as many parts.
        violated = SAFETY * self.path if broken.max() > self.path else np.inf
        finer = np.maximum(2.0, np.cbrt(beside / (SAFETY * self.path)))
        parts = np.maximum(parts, np.where(beside > violated, finer, 1.0))
        needed = np.clip(parts, 1.0, self.most)
        parts = np.maximum(needed, assessment.growth)
        if parts.max() <= 1.0:
            return mesh
        parts = _graded(mesh, parts, self.slope)
        count = int(np.ceil(max(parts.sum(), LEAST_GROWTH * mesh.count) - 1e-9))
        if count > self.finest:
            # Where not all intervals can be as many times finer, those with large errors come first.
            count, parts = self.finest, _graded(mesh, needed, self.slope)
        even = assessment.errors.max() <= tolerance or parts.max() <= LEAST_GROWTH * parts.mean()
        if count < mesh.count or (count == mesh.count and even):
            return mesh
        return _with_density(mesh, parts, count)


def evenly_finer(mesh: Mesh, growth: float) -> Mesh:
    """Return a mesh with ``growth`` times as many intervals everywhere."""
    return _with_density(mesh, np.ones(mesh.count), int(np.ceil(growth * mesh.count - 1e-9)))


def _graded(mesh: Mesh, parts: Array, slope: float) -> Array:
    """Return more parts of intervals beside short ones, so that the lengths grow by ``slope`` times the distance."""
    if not np.isfinite(slope):
        return parts
    knots, lengths = np.array(mesh.knots), np.diff(mesh.knots)
    middles = 0.5 * (knots[:-1] + knots[1:])
    allowed = lengths / parts + slope * np.abs(middles[:, None] - middles)
    return np.asarray(lengths / allowed.min(axis=1))


def _with_density(mesh: Mesh, parts: Array, count: int) -> Mesh:
    """Place ``count`` intervals with equal shares of the density that has ``parts`` in every interval."""
    shares = np.append(0.0, np.cumsum(parts)) / float(parts.sum())
    knots = np.interp(np.linspace(0.0, 1.0, count + 1), shares, np.array(mesh.knots))
    knots[0], knots[-1] = 0.0, 1.0
    return Mesh(tuple(knots.tolist()), _schemes(mesh, knots))


def _schemes(mesh: Mesh, knots: Array) -> Scheme | tuple[Scheme, ...]:
    """Give every interval the scheme that the old mesh has at its middle."""
    if len(mesh.given) == 1:
        return mesh.given[0]
    owners = np.searchsorted(mesh.knots, 0.5 * (knots[:-1] + knots[1:]), side="right") - 1
    return tuple(mesh.schemes[owner] for owner in owners)
