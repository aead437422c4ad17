"""Published and recomputed optima: every case of cases/systems.yaml on the meshes of its table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
import yaml

import robotraj as rt
from robotraj.guess.ends import default_parameters
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess

CASES = {case["id"]: case for case in yaml.safe_load((Path(__file__).parent / "cases" / "systems.yaml").read_text())}
LECTURE = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
SCHEMES = {
    "trap": rt.schemes.Trapezoidal(),
    "hs": rt.HermiteSimpson(),
    "lecture": LECTURE,
    "fifth": rt.schemes.FifthDegree(),
    "radau3": rt.schemes.RadauIIA(points=3),
}
SLOW = {("space_reorientation", 120), ("hypersensitive", 400), ("block_move_min_work", 160)}


def number(value: Any) -> float:
    """A number, or an expression such as ``2*pi``."""
    return float(eval(value, {"pi": np.pi, "sin": np.sin}) if isinstance(value, str) else value)


@dataclass(frozen=True)
class Line(InitialGuess):
    """States and controls on straight lines through rows."""

    duration: float
    fractions: Any
    states: Any
    controls: Any

    def of(self, phase: rt.Phase, index: int) -> PhaseGuess:
        def through(fractions: Any, rows: Any) -> Any:
            return lambda s: np.column_stack([np.interp(s, fractions, column) for column in np.array(rows).T])

        return PhaseGuess(
            self.duration,
            through(self.fractions, self.states),
            lambda s: np.zeros((len(s), 0)),
            through([0, 1], self.controls),
            default_parameters(phase),
        )


def system_of(case: Mapping[str, Any]) -> rt.System:
    """The case's equations as a System."""
    functions = {"sin": ca.sin, "cos": ca.cos, "sqrt": ca.sqrt, "pi": np.pi, **case.get("params", {})}

    def known(point: Any) -> dict[str, Any]:
        names = {**functions, **dict(point.x), **dict(point.u)}
        for name, text in case.get("let", {}).items():
            names[name] = eval(text, names)
        return names

    def rates(point: Any) -> list[Any]:
        names = known(point)
        return [eval(text, names) for text in case["rhs"]]

    return rt.System(case["states"], case["controls"], rates, name=case["id"])


def phase_of(case: Mapping[str, Any]) -> rt.Phase:
    """The case as a phase."""

    def expression(text: str) -> Any:
        return lambda point: eval(text, {**dict(point.x), **dict(point.u)})

    def bounds(names: list[str], rows: list[Any] | None) -> dict[str, Any]:
        pairs = zip(names, rows or [None] * len(names), strict=True)
        ends = {name: [None if end is None else number(end) for end in row] for name, row in pairs if row is not None}
        return {name: rt.between(*row) for name, row in ends.items()}

    def state(row: list[Any]) -> rt.State:
        return rt.State([None if value is None else number(value) for value in row])

    constraints = [rt.PathConstraint(expression(case["path"]), lower=0, upper=0)] if "path" in case else []
    duration = case["T"]
    return rt.Phase(
        system_of(case),
        duration=tuple(duration) if isinstance(duration, list) else duration,
        start=state(case["initial"]),
        end=state(case["final"]),
        states=bounds(case["states"], case.get("state_bounds")),
        controls=bounds(case["controls"], case["control_bounds"]),
        constraints=constraints,
        objective=rt.Duration() if "mayer" in case else rt.Lagrange(expression(case["lagrange"])),
        name=case["id"],
    )


def guess_of(case: Mapping[str, Any]) -> Line:
    """The case's own guess."""
    given = case["guess"]
    rows = [[number(value) for value in row] for row in given["x"]]
    return Line(given.get("T", case["T"]), given.get("s", [0, 1]), rows, given["u"])


def solve(case: Mapping[str, Any], scheme: str, intervals: int) -> rt.Solution:
    """Plan the case from its own guess."""
    solver = rt.Ipopt(initial_barrier=case.get("initial_barrier", rt.Ipopt().initial_barrier))
    return rt.plan(phase_of(case), rt.Mesh(intervals, SCHEMES[scheme]), guess_of(case), solver)


def table() -> list[Any]:
    rows = []
    for name, case in CASES.items():
        for scheme, values in case.get("mesh", {}).items():
            for intervals, value in values.items():
                marks = [pytest.mark.slow] if (name, intervals) in SLOW else []
                rows.append(
                    pytest.param(name, scheme, intervals, value, id=f"{name}-{scheme}-{intervals}", marks=marks)
                )
    return rows


@pytest.mark.parametrize(("name", "scheme", "intervals", "value"), table())
def test_optimum_on_a_mesh_is_that_of_an_independent_implementation(
    name: str, scheme: str, intervals: int, value: float
) -> None:
    case = CASES[name]
    solution = solve(case, scheme, intervals)
    assert solution.success
    assert solution.objective == pytest.approx(value, rel=case["to"])


def nearest() -> list[Any]:
    return [
        pytest.param(name, marks=[pytest.mark.slow] if (name, case["near"][1]) in SLOW else [])
        for name, case in CASES.items()
    ]


@pytest.mark.parametrize("name", nearest())
def test_optimum_is_the_exact_one_within_what_the_mesh_allows(name: str) -> None:
    case = CASES[name]
    scheme, intervals, distance = case["near"]
    solution = solve(case, scheme, intervals)
    assert solution.objective == pytest.approx(case["exact"], rel=distance)
