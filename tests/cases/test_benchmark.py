"""The table of `python benchmarks/cases.py`: every case reaches its optimum from its guess, without a given mesh."""

from __future__ import annotations

import pytest
import yaml
from cases import cases, line, markdown
from problems.case import TOLERANCE, Case, run
from problems.references import REFERENCES
from problems.written import MORE, written

import robotraj as rt

EVERY = list(cases())
FURTHER = {case.name: case for case in written(MORE)}


@pytest.mark.slow
@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_every_case_reaches_its_optimum_at_a_tolerance_of_1e_6(case: Case) -> None:
    result = run(case)
    assert result.solution.success
    assert result.error <= result.allowed
    assert result.allowed == max(1e-6, case.accuracy)
    assert result.solution.refinement[-1].error <= 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)
def test_the_default_call_proves_every_case(case: Case) -> None:
    solution = rt.plan(case.problem, guess=case.guess)
    assert solution.proof is not None and solution.proof.holds
    assert solution.objective == pytest.approx(case.exact, rel=solution.proof.goals.objective, abs=1e-5)
    assert rt.validate(solution).passed


@pytest.mark.parametrize("name", ["kirk_5_1_1", "pendulum, URDF", "breakwell_touch", "biped, torso of the table"])
def test_a_quick_case_reaches_its_optimum(name: str) -> None:
    (case,) = (case for case in EVERY if case.name == name)
    result = run(case)
    assert result.reached
    written_line = line(result)
    assert written_line[0] == name and written_line[-1] == "reached"
    assert markdown([written_line]).splitlines()[2] == f"| {' | '.join(written_line)} |"


@pytest.mark.parametrize("name", ["brachistochrone", "biped, torso of the code", "sliding mass, 3 phases"])
def test_the_interior_point_method_reaches_it_with_nothing_to_fall_back_on(name: str) -> None:
    """The first stalls unless each barrier problem is solved more accurately; added rows of the second are linear."""
    (case,) = (case for case in EVERY if case.name == name)
    solver = rt.InteriorPoint(fallback=None)
    solution = rt.plan(case.problem, guess=case.guess, tolerance=TOLERANCE, solver=solver)
    assert solution.objective == pytest.approx(case.exact, rel=max(TOLERANCE, case.accuracy))


def test_a_wrong_optimum_is_a_miss() -> None:
    (case,) = (case for case in EVERY if case.name == "kirk_5_1_1")
    wrong = Case(case.name, case.problem, case.guess, case.exact * (1 + 1e-5), 0.0, "wrong on purpose")
    result = run(wrong)
    assert result.solution.success and not result.reached
    assert line(result)[-1].startswith("missed")


@pytest.mark.parametrize("name", REFERENCES)
def test_optima_without_closed_form_are_found_again_without_collocation(name: str) -> None:
    case = FURTHER[name]
    assert REFERENCES[name]() == pytest.approx(case.exact, rel=case.accuracy)


def test_every_further_case_has_a_closed_form_or_a_reference() -> None:
    sources = {entry["id"]: entry["source"] for entry in yaml.safe_load(MORE.read_text())}
    without = {name for name, source in sources.items() if not source.startswith("closed form")}
    assert without == set(REFERENCES)
