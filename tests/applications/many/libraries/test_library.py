"""Libraries plan from neighbour to neighbour, and blend the solutions around a case."""

from __future__ import annotations

import io

import numpy as np
import pytest

import robotraj as rt
from robotraj.applications import Library, library

GRID = [{"end": end, "duration": duration} for end in (1.0, 2.0, 3.0) for duration in (1.0, 2.0)]


def make(case: dict[str, float]) -> rt.Phase:
    ends = rt.State(q=0, v=0), rt.State(q=case["end"], v=0)
    return rt.Phase(rt.load("block"), case["duration"], *ends, rt.Effort(), limits=None)


@pytest.fixture(scope="module")
def slides() -> Library:
    return library(make, GRID, mesh=rt.Mesh(4))


def test_every_case_has_its_optimum(slides: Library) -> None:
    """The least effort over L in T is 12 m^2 L^2 / T^3."""
    assert not slides.failures and [dict(case) for case in slides.cases] == GRID
    mass = rt.load("block").mass
    for case, solution in zip(slides.cases, slides.solutions, strict=True):
        exact = 12.0 * mass**2 * case["end"] ** 2 / case["duration"] ** 3
        assert solution.objective == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_weights_reproduce_a_case_from_the_cell_around_it(slides: Library, seed: int) -> None:
    rng = np.random.default_rng(seed)
    case = {"end": float(rng.uniform(1, 3)), "duration": float(rng.uniform(1, 2))}
    weights = slides.weights(case)
    assert weights.min() >= 0.0 and weights.sum() == pytest.approx(1.0)
    for name, value in case.items():
        assert sum(w * each[name] for w, each in zip(weights, slides.cases, strict=True)) == pytest.approx(value)
    side = 1.0 if case["end"] < 2.0 else 3.0
    assert all(each["end"] in (2.0, side) for w, each in zip(weights, slides.cases, strict=True) if w > 0.0)


def test_a_case_of_the_library_is_its_own_blend_and_one_outside_takes_the_nearest(slides: Library) -> None:
    for k, case in enumerate(slides.cases):
        assert slides.weights(case)[k] == pytest.approx(1.0)
    assert slides.weights({"end": 9.0, "duration": 1.1})[4] == 1.0


def test_a_plan_of_the_library_is_the_optimum_of_its_case(slides: Library) -> None:
    found = slides.plan({"end": 1.4, "duration": 1.7}, mesh=rt.Mesh(4))
    exact = 12.0 * rt.load("block").mass ** 2 * 1.4**2 / 1.7**3
    assert found.objective == pytest.approx(exact, rel=1e-6)


@pytest.fixture(scope="module")
def reaches() -> Library:
    """Motions of an arm to places near each other, each with its proof."""
    arm = rt.load("two_link_arm")

    def reach(case: dict[str, float]) -> rt.Phase:
        ends = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["shoulder"], case["elbow"]], v=0)
        return rt.Phase(arm, 6.0, *ends, rt.Effort())

    return library(reach, [{"shoulder": s, "elbow": e} for s in (1.0, 1.2) for e in (0.4, 0.6)])


def test_a_plan_from_the_nearest_case_is_proved_on_its_mesh_in_fewer_iterations(reaches: Library) -> None:
    case = {"shoulder": 1.13, "elbow": 0.55}
    cold = rt.plan(reaches.make(case))
    found = reaches.plan(case)
    assert found.proved and found.objective == pytest.approx(cold.objective, rel=1e-3)
    assert len(found.refinement) == 1
    assert found.iterations < 0.6 * cold.iterations


def test_all_solutions_of_a_library_share_one_program_and_keep_none(reaches: Library) -> None:
    """The next plan changes the numbers of the program that the last one used."""
    from robotraj.solvers.compiled import origin_of
    from robotraj.solvers.kept_multipliers import KeptMultipliers

    assert all(isinstance(each.multipliers, KeptMultipliers) for each in reaches.solutions)
    used = []
    for case in ({"shoulder": 1.02, "elbow": 0.42}, {"shoulder": 1.18, "elbow": 0.58}):
        reaches.plan(case)
        first = reaches._neighbours._first
        origin = None if first is None else origin_of(first.multipliers)
        assert origin is not None
        used.append(origin.compiled)
    assert used[0] is used[1]


def test_a_solution_whose_program_cannot_be_built_again_keeps_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Such programs have rows on distances; each takes some 20 MB."""
    from robotraj.applications.many.libraries.neighbours import without_program
    from robotraj.solvers.kept_multipliers import KeptMultipliers

    solution = rt.plan(make(GRID[0]), mesh=rt.Mesh(4), keep_program=True)
    assert isinstance(without_program(solution).multipliers, KeptMultipliers)
    monkeypatch.setattr(KeptMultipliers, "of", classmethod(lambda cls, known: None))
    found = without_program(solution)
    assert found.multipliers is None and not found.duals and found.objective == solution.objective


def test_an_answer_meets_its_rows_near_the_optimum(reaches: Library) -> None:
    for case in ({"shoulder": 1.07, "elbow": 0.45}, {"shoulder": 1.15, "elbow": 0.55}):
        answer, optimum = reaches.answer(case), reaches.plan(case)
        assert answer.fresh and answer.violation < 1e-4
        q = answer.at(6.0).q
        assert q == pytest.approx([case["shoulder"], case["elbow"]], abs=1e-6)
        times = np.linspace(0.0, 6.0, 20)
        assert np.abs(answer.at(times).q - optimum.at(times).q).max() < 0.02


def test_motions_are_exported_as_arrays(slides: Library) -> None:
    """They hold q(s) = L (3 s^2 - 2 s^3)."""
    file = io.BytesIO()
    np.savez(file, **slides.arrays(11))
    file.seek(0)
    read = np.load(file)
    s = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(read["t"], read["duration"][:, None] * s, atol=1e-12)
    np.testing.assert_allclose(read["q"][..., 0], read["end"][:, None] * (3 * s**2 - 2 * s**3), atol=1e-6)
    assert read["tau"].shape == (6, 11, 1)


def test_a_library_takes_a_function() -> None:
    with pytest.raises(rt.InputError, match=r"takes a function, make\(case\) -> problem"):
        rt.applications.library("slide", [{"far": 1.0}])  # type: ignore[arg-type]


def test_cases_that_fail_are_listed_and_the_others_are_solved() -> None:
    def some(case: dict[str, float]) -> rt.Phase:
        if case["end"] == 2.0:
            raise ValueError("no such case")
        return make(case)

    found = library(some, [{"end": end, "duration": 1.0} for end in (1.0, 2.0, 3.0)], mesh=rt.Mesh(3))
    assert len(found.solutions) == 2
    ((case, failure),) = found.failures
    assert case["end"] == 2.0 and "no such case" in failure.cause


@pytest.mark.parametrize(
    ("cases", "message"),
    [([], "must be mappings"), ([{"end": 1.0}, {"place": 1.0}], "other numbers"), ([{"end": np.nan}], "not finite")],
)
def test_cases_are_mappings_with_the_same_finite_numbers(cases: list[dict[str, float]], message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        library(make, cases)


@pytest.mark.slow
def test_a_trot_at_a_speed_between_two_others_has_its_optimum_from_their_blend() -> None:
    robot = rt.load("solo12", root="floating")
    gaits = library(
        lambda case: rt.gait.trot(robot, speed=case["speed"], duration=0.2, clearance=0.04),
        [{"speed": speed} for speed in (0.2, 0.3, 0.4)],
        mesh=rt.Mesh(6),
    )
    assert len(gaits.solutions) == 3
    case = {"speed": 0.25}
    blended = gaits.plan(case, mesh=rt.Mesh(6))
    alone = rt.plan(gaits.make(case), mesh=rt.Mesh(6))
    assert blended.objective == pytest.approx(alone.objective, rel=1e-4)
