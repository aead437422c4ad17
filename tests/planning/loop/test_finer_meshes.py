"""Meshes that hardly grow are refined further, so that the largest number of meshes does not end a plan."""

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.values import dataclass
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.base import Assessment, Refinement


@dataclass(frozen=True)
class Cautious(Refinement):
    """One interval more for the tolerance itself, twice as many for a smaller goal."""

    tolerance: float

    def refine(self, mesh: rt.Mesh, assessment: Assessment, tolerance: float) -> rt.Mesh:
        """Return the next mesh."""
        count = mesh.count + 1 if tolerance >= self.tolerance else 2 * mesh.count
        return rt.Mesh(count, mesh.schemes[0])


def test_a_refinement_that_adds_an_interval_at_a_time_is_asked_for_more():
    swing = rt.Phase(rt.load("pendulum"), 2.0, rt.State(q=0, v=0), rt.State(q=2.0, v=0), None)
    coarse = rt.Mesh(60, rt.schemes.Trapezoidal())
    solution = rt.plan(swing, coarse, tolerance=1e-6, refinement=Cautious(1e-6), check=False)
    assert solution.status is Status.SOLVED
    points = [step.points for step in solution.refinement]
    assert all(after >= 1.1 * before for before, after in zip(points, points[3:], strict=False)) and len(points) > 3


@pytest.mark.parametrize("seed", [3, 11])
def test_least_time_ends_within_the_tolerance_and_not_just_above(seed):
    """Meshes that grew by an interval each ended at 1.07 to 1.5 times the tolerance."""
    arm, random = rt.load("ur5"), np.random.default_rng(seed)
    first, last = random.uniform(-1.5, 1.5, (2, arm.nq))
    phase = rt.Phase(arm, (0.1, 10.0), rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Duration())
    solution = rt.plan(phase, tolerance=1e-4)
    assert solution.status is Status.SOLVED and solution.error <= 1e-4
