"""What rows between links cost bounds what a solve gains with rows along its solution."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.proving.free_solution import FreeSearch
from robotraj.planning.proving.held_back import held_back
from robotraj.planning.proving.own_overlaps import OwnOverlaps, motion_of

FIRST, LAST = np.array([-1.4, 0.79, -1.94, -1.47, 0.44, 0.75]), np.array([-0.94, -1.93, 0.38, 2.3, 0.37, -1.43])


@pytest.fixture(scope="module")
def solutions() -> tuple[OwnOverlaps, list[rt.Solution]]:
    """Solves on a coarse mesh around the overlaps of an arm, each with rows along the one before it."""
    phase = rt.Phase(rt.load("ur5"), 2.44, rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0), rt.Effort())
    problem, plan = rt.Problem([phase]), rt.plan(phase)
    own = plan.settings
    overlaps, found = OwnOverlaps(problem), [plan]
    pairs = [set(overlaps.touching(0, motion_of(plan.phases[0])))]
    for _ in range(3):
        motions = [motion_of(part) for part in found[-1].phases]
        search = FreeSearch.begin(problem, overlaps.bodies, motions, True, pairs, found[-1])
        found.append(solve(problem, found[-1], own, surfaces=search.surfaces))
    return overlaps, found


def test_what_rows_cost_bounds_what_rows_along_the_solution_gain(
    solutions: tuple[OwnOverlaps, list[rt.Solution]],
) -> None:
    overlaps, (_, *found) = solutions
    costs = [held_back(each, overlaps.bodies) for each in found]
    gains = [before.objective - after.objective for before, after in zip(found[:-1], found[1:], strict=True)]
    assert all(each.success for each in found) and min(costs) > 0.0
    # Motors' torques are not convex in the positions, so that a gain may exceed its bound a little.
    assert all(gain <= 1.1 * cost for gain, cost in zip(gains, costs[:-1], strict=True))


def test_a_solution_without_rows_between_links_is_not_held_back() -> None:
    phase = rt.Phase(
        rt.load("ur5"), 1.0, rt.State(q=FIRST, v=0), rt.State(q=FIRST + 0.2, v=0), rt.Effort(), self_collision=False
    )
    solution, overlaps = rt.plan(phase), OwnOverlaps(rt.Problem([phase]))
    assert held_back(solution, overlaps.bodies) == 0.0
