"""Compiled C returns the values of CasADi's virtual machine at all points."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.native.engines.base import Mapped
from robotraj.native.engines.compiler import find_compiler, points_at_once
from robotraj.native.engines.source import Source, write_source
from tests.programs import nlp_of

Posed = tuple[rt.Problem, rt.Mesh]


def values(nlp: rt.transcription.Nlp, w: np.ndarray, m: np.ndarray) -> list[np.ndarray]:
    derivatives = nlp.jacobian(w).toarray(), nlp.hessian(w, m).toarray()
    return [np.array([nlp.objective(w)]), nlp.values(w), nlp.gradient(w), *derivatives]


def compare(problem: rt.Problem, mesh: rt.Mesh, engine: rt.engines.Compiled) -> rt.transcription.Nlp:
    rng = np.random.default_rng(0)
    plain, fast = (
        rt.transcription.transcribe(problem, mesh, rt.guess.StraightLine(), engine=e) for e in (None, engine)
    )
    for _ in range(3):
        w = plain.guess + 0.1 * rng.standard_normal(len(plain.guess))
        m = rng.standard_normal(len(plain.rows))
        for expected, found in zip(values(plain, w, m), values(fast, w, m), strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max(initial=1.0))
    assert engine.libraries(fast.point_functions)
    return fast


def test_rows_objective_and_derivatives_are_the_same(posed: Posed, engine: rt.engines.Compiled) -> None:
    problem, mesh = posed
    nlp = compare(problem, mesh, engine)
    # Every stage function of these problems is in the cache: the virtual machine evaluated none of them.
    large = [each.function for each in nlp.point_functions if each.count >= points_at_once()]
    assert len(engine.libraries(nlp.point_functions)) >= len(large) > 2


@pytest.mark.slow
def test_a_robot_with_contacts_and_a_free_root_is_the_same(stance: Posed, tmp_path: Path) -> None:
    compare(*stance, rt.engines.Compiled(cache=tmp_path / "cache"))


def test_compiled_derivatives_are_those_of_compiled_values(posed: Posed, engine: rt.engines.Compiled) -> None:
    problem, mesh = posed
    nlp = rt.transcription.transcribe(problem, mesh, rt.guess.StraightLine(), engine=engine)
    rng = np.random.default_rng(1)
    w = nlp.guess + 0.1 * rng.standard_normal(len(nlp.guess))
    m, direction, h = rng.standard_normal(len(nlp.rows)), rng.standard_normal(len(w)), 1e-6

    def slope(function: object) -> np.ndarray:
        return (function(w + h * direction) - function(w - h * direction)) / (2 * h)  # type: ignore[operator]

    np.testing.assert_allclose(nlp.jacobian(w) @ direction, slope(nlp.values), rtol=1e-6, atol=1e-6)
    expected = slope(lambda at: nlp.gradient(at) + nlp.jacobian(at).T @ m)
    np.testing.assert_allclose(nlp.hessian(w, m) @ direction, expected, rtol=1e-5, atol=1e-5 * np.abs(expected).max())


def test_a_plan_takes_the_same_steps_to_the_same_answer(swing_up: Posed, engine: rt.engines.Compiled) -> None:
    problem, mesh = swing_up
    plain, fast = (
        rt.plan(problem, mesh, rt.guess.StraightLine(), check=False, solver=rt.Ipopt(), engine=e)
        for e in (None, engine)
    )
    assert fast.status is plain.status and fast.iterations == plain.iterations
    assert fast.objective == pytest.approx(plain.objective, rel=1e-9)
    t = np.linspace(0, plain.duration, 50)
    np.testing.assert_allclose(fast.at(t).q, plain.at(t).q, rtol=1e-9, atol=1e-9)
    assert fast.times["compile"] > plain.times["compile"]


@pytest.mark.parametrize("count", [4, 5, 8, 9, 17])
def test_any_number_of_points(count: int, polynomial: ca.Function, engine: rt.engines.Compiled) -> None:
    [mapped] = engine.prepare([Mapped(polynomial, count)])
    rng = np.random.default_rng(count)
    arguments = rng.standard_normal((3, count)), rng.standard_normal((2, count))
    assert engine.libraries([Mapped(polynomial, count)])
    np.testing.assert_array_equal(np.array(mapped(*arguments)), np.array(polynomial.map(count)(*arguments)))


@pytest.mark.parametrize("lines", [1, 3, 7, 1000])
@pytest.mark.parametrize("points", [1, 2, 4])
def test_a_function_may_be_cut_anywhere(lines: int, points: int, tmp_path: Path) -> None:
    x, c = ca.SX.sym("x", 4), ca.SX.sym("c", 1)
    y = ca.SX.zeros(3)
    for i in range(3):
        y[i] = ca.sin(x[i]) * c + x[3] ** 2 / (1.5 + x[i] ** 2) - 1e-3 * ca.dot(x, x) + 2.0 ** x[i]
    y[2] += -y[0] * y[1] + ca.fmin(x[0], c) + ca.sign(x[1]) + ca.floor(x[2])
    function = ca.Function("cut", [x, c], [ca.vertcat(y, -0.0, x[0], 1e300, ca.if_else(x[0] < c, y[0], y[1]))])
    source = write_source(function, points, lines)
    library = compiled_library(source, tmp_path)
    external = ca.external("cut", str(library))
    rng = np.random.default_rng(0)
    a, b = rng.standard_normal((4, points)), rng.standard_normal((1, points))
    expected = np.array(function.map(points)(a, b))
    found = np.array(external(a, b))
    np.testing.assert_array_equal(found, expected)
    assert np.all(np.signbit(found[3]) == np.signbit(expected[3]))


def compiled_library(source: Source, folder: Path) -> Path:
    with ThreadPoolExecutor(2) as pool:
        return find_compiler().start(source, folder, pool)()


def test_files_that_each_need_casadis_helpers_link(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotraj.native.engines.source._PER_FILE", 2)
    x = ca.SX.sym("x", 5)
    source = write_source(ca.Function("squares", [x], [ca.sumsqr(ca.sin(x))]), points_at_once(), lines_per_part=2)
    assert sum("casadi_sq(casadi_real x)" in text for text in source.files) > 3
    assert compiled_library(source, tmp_path).is_file()


def test_small_functions_few_points_and_shooting_stay_with_the_virtual_machine(
    polynomial: ca.Function, tmp_path: Path
) -> None:
    engine = rt.engines.Compiled(cache=tmp_path / "cache")
    w = ca.MX.sym("w", 3)
    shot = ca.Function("shot", [w], [2 * w])
    wanted = [Mapped(polynomial, 50), Mapped(shot, 50)]
    assert [f.size_out(0) for f in engine.prepare(wanted)] == [(2, 50), (3, 50)]
    rt.engines.Compiled(least=1, cache=tmp_path / "cache").prepare([Mapped(polynomial, 1)])
    assert not (tmp_path / "cache").exists()


def test_contacts_of_which_a_row_reads_no_force_are_the_same() -> None:
    robot = rt.load("hopper", root="planar")
    still = {"root_z": 0.5, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
    phase = rt.Phase(
        robot,
        duration=1.0,
        contacts=[rt.contacts.ImplicitContact("foot", friction=0.8, relaxation=1.0)],
        start=rt.State(q=still | {"root_x": 0.0}, v=0),
        end=rt.State(q=still | {"root_x": 0.5}, v=0),
        objective=rt.Effort({"hip": 1.0, "leg": 0.01}),
    )
    mesh = rt.Mesh(3, rt.schemes.RadauIIA(1))
    plain, native = (
        nlp_of(rt.Problem([phase]), mesh, engine=engine)
        for engine in (rt.engines.VirtualMachine(), rt.engines.Native())
    )
    w = plain.guess + 0.1 * np.random.default_rng(3).standard_normal(len(plain.guess))
    m = np.random.default_rng(4).standard_normal(len(plain.rows))
    np.testing.assert_allclose(native.values(w), plain.values(w), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(native.jacobian(w).toarray(), plain.jacobian(w).toarray(), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(native.hessian(w, m).toarray(), plain.hessian(w, m).toarray(), rtol=1e-8, atol=1e-8)
