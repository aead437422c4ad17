"""A user's function of cases: its errors name the case, and it returns problems."""

from __future__ import annotations

import pytest

import robotraj as rt
from robotraj._util.errors import FailedExpression
from robotraj.applications import codesign, pareto
from robotraj.applications.many.posed import posed

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


def move(case: dict[str, float]) -> rt.Phase:
    return rt.Phase(BLOCK, case["time"], rt.State([0, 0]), rt.State([1, 0]), rt.Lagrange(lambda p: p.u["u"] ** 2))


def test_a_phase_is_a_problem_of_one() -> None:
    problem = posed(move, {"time": 2.0})
    assert len(problem.phases) == 1 and posed(lambda case: problem, None) is problem


def test_an_error_names_the_case_and_keeps_its_cause() -> None:
    message = r"make\(case\) failed: KeyError: 'time'\. The case is .*duration"
    with pytest.raises(FailedExpression, match=message) as caught:
        codesign(move, {"duration": (1.0, 2.0)})
    assert isinstance(caught.value.__cause__, KeyError)


def test_what_is_no_problem_is_refused() -> None:
    with pytest.raises(rt.InputError, match="returned None; let it return an rt.Problem or an rt.Phase"):
        pareto(lambda weight: None, (1e-3, 1.0))  # type: ignore[arg-type, return-value]


@pytest.mark.parametrize("error", [MemoryError("full"), rt.InputError("its own words")])
def test_a_lack_of_memory_and_errors_of_robotraj_pass(error: Exception) -> None:
    def fail(case: object) -> rt.Phase:
        raise error

    with pytest.raises(type(error)) as caught:
        posed(fail, {})
    assert caught.value is error
