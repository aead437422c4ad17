"""What follows from the errors of a solve, as a table: nothing is solved here."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.loop.respond import respond
from robotraj.planning.loop.state import Found, PlanEnd, begin
from robotraj.planning.loop.to_tolerance import MOST_MESHES
from robotraj.planning.loop.tolerance_state import Errors, ToleranceState
from robotraj.planning.settings import resolve
from robotraj.solution.records import MeshStep
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.base import Assessment
from robotraj.transcription.refinement.linear_controls import LINES

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
PROBLEM = rt.Problem([rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort())])
MESH, TOLERANCE = rt.Mesh(20, rt.schemes.RadauIIA(3)), 1e-4


@dataclass(frozen=True)
class Solved:
    """Of a solution, what a response reads."""

    status: Status = Status.SOLVED
    iterations: int = 20
    seconds: float = 0.1
    objective: float = 1.0
    multipliers: Any = None
    refinement: tuple[Any, ...] = ()

    @property
    def success(self) -> bool:
        return self.status is Status.SOLVED

    @property
    def phases(self) -> tuple[Any, ...]:
        return (SimpleNamespace(mesh=MESH, points=range(60)),)


def found(error: float = 0.0, left: float = 0.0, excess: float = 0.0, limited: bool = False, **solved: Any) -> Found:
    nothing = np.zeros(20)
    each = Assessment(nothing + error, nothing, nothing + 9.0, nothing + excess, left <= TOLERANCE, nothing)
    errors = Errors((each,), TOLERANCE, left, TOLERANCE)
    return Found(Solved(**solved), limited=limited, lacks=errors.lacks, errors=errors)  # type: ignore[arg-type]


def state(*errors: float, **changes: Any) -> ToleranceState:
    """Return the state after meshes with these errors."""
    first = begin(PROBLEM, None, resolve(PROBLEM, {"tolerance": TOLERANCE, "mesh": MESH}))
    steps = tuple(MeshStep(20, 60, error, 1.0, 20, 0.1) for error in errors)
    best = Solved() if errors else None
    assert isinstance(first, ToleranceState)
    return replace(first, best=best, steps=steps, **changes)  # type: ignore[arg-type]


FAILED = {"status": Status.STALLED}

RESPONSES = [
    ("errors have a finer mesh", state(), found(1e-2, np.inf), "points"),
    ("so has an objective that has not settled", state(1e-5), found(1e-5, 1e-2), "points"),
    ("a motion within its errors is the plan", state(1e-5), found(1e-5, 1e-5, limited=True), Status.SOLVED),
    ("a path row is met on shorter intervals", state(1e-5), found(excess=1e-2, limited=True), "intervals"),
    ("while its excess falls", state(1e-5, excess=1e-2), found(excess=1e-2, limited=True), Status.SOLVED),
    ("a first mesh that fails is the end", state(), found(**FAILED), Status.STALLED),
    ("a later one has lines", state(1e-2), found(**FAILED), "lines"),
    ("a first mesh without end has lines", state(), found(iterations=5000, **FAILED), "lines"),
    ("a smaller gap is taken back where it fails", state(gap=0.1), found(**FAILED), "gap"),
    ("limits are imposed before a plan ends", state(*[1.0] * (MOST_MESHES - 1)), found(1e-2), "limits"),
    ("that solve is the last", state(1e-2, is_last=True, limited=True), found(1e-2), Status.TOLERANCE_NOT_REACHED),
    ("a time limit is the end", state(1e-2), found(status=Status.TIME_LIMIT), Status.TIME_LIMIT),
]


@pytest.mark.parametrize(
    ("before", "solve", "expected"), [row[1:] for row in RESPONSES], ids=[row[0] for row in RESPONSES]
)
def test_a_response_follows_from_the_errors(before: ToleranceState, solve: Found, expected: object) -> None:
    after = respond(before, solve)
    if isinstance(expected, Status):
        assert isinstance(after, PlanEnd) and after.solution.status is expected
        return
    assert isinstance(after, ToleranceState)
    mesh = after.meshes[0]
    counts = (mesh.count, sum(len(scheme.nodes) for scheme in mesh.schemes))  # type: ignore[attr-defined]
    assert {
        "points": counts[1] > 60,
        "intervals": counts[0] > 20,
        "lines": mesh.given == (LINES,) and after.first == len(after.steps),
        "gap": after.gap == 0.0 and after.meshes == before.meshes and after.steps == before.steps,
        "limits": after.limited and after.is_last and after.meshes == (MESH,),
    }[str(expected)]


def test_a_finer_mesh_that_fails_leaves_the_solution_on_the_coarser_one() -> None:
    lines = respond(state(1e-2), found(**FAILED))
    limits = respond(lines, found(**FAILED))  # type: ignore[arg-type]
    assert isinstance(limits, ToleranceState) and limits.is_last
    end = respond(limits, found(1e-2, limited=True, objective=1.5))
    assert isinstance(end, PlanEnd) and end.solution.status is Status.TOLERANCE_NOT_REACHED
    assert end.solution.objective == 1.5
