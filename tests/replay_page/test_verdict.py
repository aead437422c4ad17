"""The page claims no more than was proved, and marks violated rows on the curves of their variables."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import robotraj as rt
from robotraj.replay_page.verdict import figures, proof_data, verdict
from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.solution.conflict import Conflict
from robotraj.solution.proof import Goals, Proof
from robotraj.solution.records import MeshStep
from robotraj.solution.violation import Violation

HOLDS = Proof(1e-6, 1e-4, 1e-5, 1e-5, Goals())


@pytest.fixture(scope="module")
def solution() -> rt.Solution:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, 4.0, rt.State(q=0, v=0), rt.State(q=[1, 0.5], v=0), rt.Effort(), name="reach")
    return rt.plan(phase, mesh=rt.Mesh(6))


@pytest.mark.parametrize(
    ("proof", "status", "colour", "text"),
    [
        (None, "SOLVED", "unproved", "solved; nothing was proved"),
        (HOLDS, "SOLVED", "unproved", "proved, not validated"),
        (replace(HOLDS, unsettled=0.1), "SOLVED", "unproved", "motion proved, objective not settled"),
        (replace(HOLDS, error=np.inf), "NOT_PROVED", "unproved", "not proved"),
        (None, "TOLERANCE_NOT_REACHED", "unproved", "tolerance not reached"),
        (HOLDS, "INFEASIBLE", "bad", "infeasible"),
    ],
)
def test_without_a_validation_nothing_is_green(
    solution: rt.Solution, proof: Proof | None, status: str, colour: str, text: str
) -> None:
    judged = verdict(replace(solution, proof=proof, status=rt.solvers.Status[status]))
    assert (judged.colour, judged.text) == (colour, text)


@pytest.mark.parametrize(
    ("proof", "status", "passed", "colour", "text"),
    [
        (None, "SOLVED", True, "unproved", "validated by simulation; not judged: optimum"),
        (None, "SOLVED", False, "bad", "validation failed"),
        (HOLDS, "SOLVED", True, "good", "proved and validated"),
        (HOLDS, "SOLVED", False, "bad", "validation failed"),
        (
            replace(HOLDS, unsettled=0.1),
            "SOLVED",
            True,
            "unproved",
            "motion proved, objective not settled; validated; not judged: optimum",
        ),
        (replace(HOLDS, error=np.inf), "NOT_PROVED", True, "unproved", "not proved; validated"),
        (None, "INFEASIBLE", True, "bad", "infeasible"),
    ],
)
def test_a_report_changes_the_verdict(
    solution: rt.Solution, proof: Proof | None, status: str, passed: bool, colour: str, text: str
) -> None:
    settled = proof is not None and proof.holds
    judgement = Judgement.HOLDS if settled or status == "NOT_PROVED" else Judgement.NOT_JUDGED
    claims = (Claim("motion", Judgement.HOLDS, "", "", ""), Claim("optimum", judgement, "", "", ""))
    report = SimpleNamespace(passed=passed, duration=4.0, claims=claims)
    judged = verdict(replace(solution, proof=proof, status=rt.solvers.Status[status]), report)
    assert (judged.colour, judged.text) == (colour, text)


def test_figures_stand_beside_their_goals(solution: rt.Solution) -> None:
    shown = {f.name: f for f in figures(replace(solution, proof=replace(HOLDS, excess=0.2)))}
    missed = shown["limits and constraints: fails"]
    assert (missed.value, missed.goal, missed.colour) == (0.2, 1e-3, "bad")
    assert shown["motion: holds"].colour == "good" and shown["own body: not judged"].colour == "unproved"
    assert all(figure.colour != "good" for figure in figures(solution)), "nothing was proved on a given mesh"
    error = next(figure for figure in figures(solution) if figure.name == "error between knots")
    assert error.value == pytest.approx(solution.error, rel=1e-5), "the error of a given mesh is shown, without a goal"


def test_violations_name_the_curve_and_the_worst_of_each_row(solution: rt.Solution) -> None:
    far = Violation("reach", "effort limit", "elbow", 1.0, 0.5, "N m", 1.0, "over")
    found = (replace(far, time=2.0, amount=0.1), far, replace(far, name="defect", joint="q.elbow"))
    other = Violation("reach", "ground clearance", "tip", 1.0, np.inf, "m", 0.0, "under")
    shown = proof_data(
        replace(solution, violation_list=found, interval_violations=(other,), control_interval_violations=())
    )["violations"]
    assert [(v["variable"], v["t"]) for v in shown] == [(None, 1.0), ("tau.elbow", 1.0), ("q.elbow", 1.0)]


def test_every_mesh_of_a_refinement_is_listed(solution: rt.Solution) -> None:
    steps = (MeshStep(4, 9, 1e-2, 2.0, 20, 0.1), MeshStep(8, 17, np.inf, 1.9, 5, 0.2))
    data = proof_data(replace(solution, refinement=steps))
    assert [mesh["error"] for mesh in data["meshes"]] == [0.01, None]
    assert [mesh["intervals"] for mesh in data["meshes"]] == [4, 8]
    (given,) = proof_data(solution)["meshes"]
    assert (given["intervals"], given["error"]) == (6, None)
    assert data["problem"].startswith("phase 'reach'") and "solver" in data["settings"]


def test_conflicts_of_several_phases_name_theirs(solution: rt.Solution) -> None:
    longer = Conflict("reach", "duration", 2.0, 1.0, 2.0, "s", 1.0)
    failed = replace(solution, conflicts=(longer,))
    assert proof_data(failed)["conflicts"] == ["duration: 1 s may have to become 2 s"]
    twice = replace(failed, phases=solution.phases * 2)
    assert proof_data(twice)["conflicts"] == ["duration: 1 s may have to become 2 s (phase 'reach')"]
