"""h-refinement: intervals of large error are split, neighbours of small error are merged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.checks import is_whole
from robotraj._util.errors import InputError
from robotraj._util.precision import ROUND_OFF
from robotraj._util.values import dataclass
from robotraj.transcription.refinement.base import Assessment, Refinement, error_order
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.integrators import Adaptive
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.schemes.shooting import Shooting

BULK = 0.8
"""Share of the controls' coarseness that one refinement removes."""
SHARE = 1e-2
"""Tolerance of an adaptive integrator, relative to that of the mesh."""


@dataclass(frozen=True)
class SplitAndMerge(Refinement):
    """h-refinement: split intervals of large error, merge neighbours of small error.

    The residual of s-point collocation falls as h^(s + 1), so an interval of error e is cut into
    ceil((2 e / tolerance)^(1 / (s + 1))) parts. Intervals inside which a control jumps are halved until the objective
    has settled, since the residual is small although a switch lies between two nodes.

    Shooting and compressed collocation are split in the same way, by the order of their dense output. They are never
    merged, since their knots are control sites as well. Their residual measures the error of the integration, not that
    of piecewise constant or linear controls. The same holds for collocation with such controls. Until the objective
    has settled, the intervals whose controls change most are therefore halved (``BULK``). An adaptive integrator gets
    a smaller tolerance before its intervals are split, since its error does not fall with their length.

    Parameters
    ----------
    most : int
        Largest number of parts that one interval is cut into at once.
    jump : float
        Relative change of a control, inside an interval, that counts as a switch.
    path : float
        Relative violation of a path row between the nodes that is allowed.
    """

    most: int = 4
    jump: float = 0.2
    path: float = 5e-4

    def __post_init__(self) -> None:
        if not (is_whole(self.most) and self.most >= 2):
            raise InputError(f"SplitAndMerge(most) must be at least 2, got {self.most!r}.")

    def refine(self, mesh: Mesh, assessment: Assessment, tolerance: float) -> Mesh:
        """Split and merge."""
        knots, schemes, errors = mesh.knots, mesh.schemes, assessment.errors
        tightened = tuple(_tightened(scheme, tolerance) for scheme in schemes)
        if errors.max() > tolerance and tightened != schemes:
            schemes, errors = tightened, np.zeros(len(errors))
        parts = np.array([self.parts(error, scheme, tolerance) for error, scheme in zip(errors, schemes, strict=True)])
        if not assessment.settled:
            halved = self.switching(assessment, schemes)
            parts[halved] = np.maximum(parts[halved], 2)
        new_knots, new_schemes = [0.0], list[Scheme]()
        k = 0
        while k < len(parts):
            last = k + 1
            if self._mergeable(parts, assessment, schemes, k, tolerance):
                last = k + 2
            inner = np.linspace(knots[k], knots[last], parts[k] + 1)[1:]
            new_knots += [*inner[:-1], knots[last]]
            new_schemes += [schemes[k]] * parts[k]
            k = last
        return Mesh(tuple(new_knots), tuple(new_schemes))

    def switching(self, assessment: Assessment, schemes: tuple[Scheme, ...]) -> NDArray[np.bool_]:
        """Return the intervals inside which a control jumps or is too coarse, or a path row is violated, (K,)."""
        broken = (assessment.jumps > self.jump) | (assessment.broken > self.path)
        return np.asarray(broken | _bulk(assessment.coarse, schemes))

    def parts(self, error: float, scheme: Scheme, tolerance: float) -> int:
        """Return the number of parts into which an interval of this error should be cut."""
        if error <= tolerance:
            return 1
        return int(np.clip(np.ceil((2 * error / tolerance) ** (1 / error_order(scheme))), 2, self.most))

    def _mergeable(
        self, parts: NDArray[np.int_], assessment: Assessment, schemes: tuple[Scheme, ...], k: int, tolerance: float
    ) -> bool:
        """Whether two neighbours, away from switches, would stay far below the tolerance as one interval."""
        if k + 1 >= len(parts) or parts[k] > 1 or parts[k + 1] > 1 or schemes[k] != schemes[k + 1]:
            return False
        if isinstance(schemes[k], OneStep) or coarsely_controlled(schemes[k]):
            return False
        merged = assessment.errors[k : k + 2].max() * 2.0 ** error_order(schemes[k])
        return bool(merged < 0.01 * tolerance and assessment.jumps[k : k + 2].max() < 0.1 * self.jump)


def _bulk(coarse: Array, schemes: tuple[Scheme, ...]) -> NDArray[np.bool_]:
    """Return the fewest intervals with a share of ``BULK`` in the coarseness of the controls.

    Only schemes whose residual does not depend on the shape of the controls count. They are one-step schemes, all of
    whose intervals are chosen if none is coarse, and collocation with constant or linear controls.
    Source: Doerfler, A convergent adaptive algorithm for Poisson's equation, SIAM J. Numerical Analysis 33 (1996).
    """
    chosen = np.zeros(len(coarse), dtype=bool)
    stepped = isinstance(schemes[0], OneStep)
    if not stepped and (not coarse.any() or not any(map(coarsely_controlled, schemes))):
        return chosen
    order = np.argsort(-coarse)
    count = int(np.searchsorted(np.cumsum(coarse[order]), BULK * coarse.sum())) + 1
    chosen[order[: count if coarse.sum() > 0 else None]] = True
    return chosen


def coarsely_controlled(scheme: Scheme) -> bool:
    """Whether the controls have fewer values on an interval than the states."""
    return isinstance(scheme, Collocation) and len(scheme.control_sites) < len(scheme.nodes)


def _tightened(scheme: Scheme, tolerance: float) -> Scheme:
    """Return the same scheme with an adaptive integrator whose error is far below the tolerance."""
    if not isinstance(scheme, Shooting) or not isinstance(scheme.integrator, Adaptive):
        return scheme
    asked = max(SHARE * tolerance, ROUND_OFF)
    if scheme.integrator.tolerance <= asked:
        return scheme
    return replace(scheme, integrator=replace(scheme.integrator, tolerance=asked))
