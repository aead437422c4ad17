"""The interface of refinements: what they know of a solution, and the mesh that they return."""

from __future__ import annotations

from abc import ABC, abstractmethod

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.schemes.shooting import Shooting


@dataclass(frozen=True, eq=False)
class Assessment(OneLine):
    """Estimates of a phase on its mesh.

    Attributes
    ----------
    errors : ndarray (K,)
        Relative error of every interval.
    jumps : ndarray (K,)
        Largest change of a control inside every interval, relative to its range over the phase.
    decays : ndarray (K,)
        Decades by which the Legendre coefficients of the states fall per degree; large where they are smooth.
    broken : ndarray (K,)
        Relative violation of path rows that depend on controls or accelerations inside every interval.
    settled : bool
        Whether the objective changed by less than the tolerance since the last mesh.
    coarse : ndarray (K,)
        Estimated effect of the shape of the controls on the objective. It is the duration of the interval times the
        squared difference between its control and that extrapolated from a neighbour. It is used for schemes whose
        residual does not depend on it: one-step schemes, and collocation with constant or linear controls.
    growth : float
        Least factor by which the number of intervals grows, so that the objective settles.
    """

    errors: Array
    jumps: Array
    decays: Array
    broken: Array
    settled: bool
    coarse: Array
    growth: float = 1.0


class Refinement(OneLine, ABC):
    """A rule for the next mesh. A new method is one new class."""

    @abstractmethod
    def refine(self, mesh: Mesh, assessment: Assessment, tolerance: float) -> Mesh:
        """Return a mesh on which the errors should be below the tolerance."""


def error_order(scheme: Scheme) -> int:
    """Return the power of an interval's length with which the integral of its residual falls."""
    if isinstance(scheme, Shooting):
        # The dense output has a cubic piece for each substep, or one polynomial for an adaptive integrator.
        return 4 if scheme.order else scheme.degree + 1
    return 4 if isinstance(scheme, OneStep) else points_of(scheme) + 1


def points_of(scheme: Scheme) -> int:
    """Return the number of collocation points of an interval."""
    if not isinstance(scheme, Collocation):
        raise InputError(
            f"{type(scheme).__name__} has no collocation points to raise; refine it with rt.refinement.SplitAndMerge()."
        )
    return len(scheme.nodes)
