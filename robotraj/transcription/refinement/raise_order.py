"""p-refinement, and hp-refinement, which chooses between order and length by the smoothness of the solution.

The residual of s-point collocation on an interval of length h falls about as fast as h^(s + 1); with s points and
error e the number of points is raised by ceil(log_s(e / tolerance)).
Sources: Patterson, Hager and Rao, A ph mesh refinement method for optimal control, Optimal Control Applications and
Methods 36 (2015); Liu, Hager and Rao, Adaptive mesh refinement using decay rates of Legendre polynomial coefficients,
IEEE Transactions on Control Systems Technology 26 (2018).
"""

from __future__ import annotations

from dataclasses import field

import numpy as np

from robotraj._util.checks import is_whole
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.transcription.refinement.base import Assessment, Refinement, points_of
from robotraj.transcription.refinement.split_and_merge import SplitAndMerge, coarsely_controlled
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.onestep import OneStep


@dataclass(frozen=True)
class RaiseOrder(Refinement):
    """p-refinement: more points in intervals of large error, on the same knots.

    Parameters
    ----------
    most : int
        Largest number of points of an interval; an interval that has it is split in two instead.
    """

    most: int = 24

    def __post_init__(self) -> None:
        if not (is_whole(self.most) and self.most >= 3):
            raise InputError(f"RaiseOrder(most) must be at least 3 points, got {self.most!r}.")

    def refine(self, mesh: Mesh, assessment: Assessment, tolerance: float) -> Mesh:
        """Raise the order where the error is above the tolerance, or a control jumps and the objective changes."""
        knots, schemes = [0.0], list[Scheme]()
        for k, scheme in enumerate(mesh.schemes):
            wanted = self.points(scheme, assessment, k, tolerance)
            parts = 1 if wanted <= self.most else 2
            assert isinstance(scheme, Collocation)
            ends = np.linspace(mesh.knots[k], mesh.knots[k + 1], parts + 1)
            knots += [*ends[1:-1], mesh.knots[k + 1]]
            points = wanted if parts == 1 else points_of(scheme)
            schemes += [scheme if points == points_of(scheme) else scheme.with_points(points)] * parts
        return Mesh(tuple(knots), tuple(schemes))

    def points(self, scheme: Scheme, assessment: Assessment, k: int, tolerance: float) -> int:
        """Return the number of points that interval k should have."""
        now, error = points_of(scheme), assessment.errors[k]
        if error > tolerance:
            return now + int(max(1, np.ceil(np.log(2 * error / tolerance) / np.log(max(now, 2)))))
        return now


@dataclass(frozen=True)
class SplitOrRaise(Refinement):
    """hp-refinement: raise the order where the states are smooth, split where they are not or a control jumps.

    Shooting, compressed collocation and collocation with coarse controls have no order to raise and are split.

    Parameters
    ----------
    decay : float
        Decades per degree by which the Legendre coefficients must fall for an interval to count as smooth.
    raising : RaiseOrder
    splitting : SplitAndMerge
    """

    decay: float = 0.5
    raising: RaiseOrder = field(default_factory=lambda: RaiseOrder(most=12))
    splitting: SplitAndMerge = field(default_factory=SplitAndMerge)

    def refine(self, mesh: Mesh, assessment: Assessment, tolerance: float) -> Mesh:
        """Decide interval by interval."""
        if any(isinstance(scheme, OneStep) or coarsely_controlled(scheme) for scheme in mesh.schemes):
            return self.splitting.refine(mesh, assessment, tolerance)
        switching = self.splitting.switching(assessment, mesh.schemes)
        knots, schemes = [0.0], list[Scheme]()
        for k, scheme in enumerate(mesh.schemes):
            rough = switching[k] or assessment.decays[k] < self.decay
            wanted = self.raising.points(scheme, assessment, k, tolerance)
            split = (switching[k] and not assessment.settled) or (
                wanted > points_of(scheme) and (rough or wanted > self.raising.most)
            )
            parts = max(2, self.splitting.parts(assessment.errors[k], scheme, tolerance)) if split else 1
            assert isinstance(scheme, Collocation)
            ends = np.linspace(mesh.knots[k], mesh.knots[k + 1], parts + 1)
            knots += [*ends[1:-1], mesh.knots[k + 1]]
            raised = wanted > points_of(scheme) and not split
            schemes += [scheme.with_points(wanted) if raised else scheme] * parts
        return Mesh(tuple(knots), tuple(schemes))
