"""Unit tests of the parts of the indirect method."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.indirect.arcs import Side, _bang_bang, find_arcs
from robotraj.indirect.newton import find_root
from robotraj.solution.costates.densities import split
from robotraj.solution.costates.hamiltonian import Hamiltonian
from tests.programs import nlp_of

SEED = 20261121


def test_multipliers_are_a_density_where_smooth_and_an_impulse_where_one_stands_alone() -> None:
    weights = np.array([0.1, 0.4, 0.2, 0.4, 0.1])
    smooth = weights * np.array([1.0, 1.1, 1.2, 1.3, 1.4])
    lonely = np.array([0.0, 0.0, 3.0, 0.0, 0.0])
    found = split(np.column_stack([smooth, lonely]), weights)
    assert found.density[:, 0] == pytest.approx([1.0, 1.1, 1.2, 1.3, 1.4])
    assert np.all(found.impulse[:, 0] == 0)
    assert found.impulse[:, 1] == pytest.approx(lonely)
    assert weights[:, None] * found.density + found.impulse == pytest.approx(np.column_stack([smooth, lonely]))


def test_gradients_of_the_hamiltonian_are_its_differences(swing_up: Any) -> None:
    rng = np.random.default_rng(SEED)
    hamiltonian = Hamiltonian.of(swing_up())
    at = {name: rng.normal(size=(1, symbol.numel())) for name, symbol in hamiltonian.symbols.items()}
    at["t"] = at["t"][:, 0]
    values = hamiltonian(**at)
    for name in ("x", "z", "u"):
        for i in range(at[name].shape[1]):
            ends = []
            for sign in (1, -1):
                moved = at[name].copy()
                moved[0, i] += sign * 1e-6
                ends.append(hamiltonian(**{**at, name: moved})["H"][0])
            slope = (ends[0] - ends[1]) / 2e-6
            assert values[f"by_{name}"][0, i] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_newton_solves_a_problem_without_freedom_and_refuses_one_with_some(kirk: Any) -> None:
    fall = rt.System(["x"], [], lambda p: [-(p.x["x"] ** 2)])
    closed = nlp_of(rt.Problem([rt.Phase(fall, 3.0)]), rt.Mesh(4, rt.schemes.FifthDegree()))
    root = find_root(closed, 1e-12)
    assert "equations" in root.trouble
    freed = find_root(nlp_of(rt.Problem([kirk.phase()]), rt.Mesh(4)), 1e-12)
    assert not np.isfinite(freed.residual)


def test_the_switch_between_two_nodes_is_where_the_control_crosses_the_middle() -> None:
    runs = _bang_bang(np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 1.0, -0.5, -1.0]), -1.0, 1.0, 0.1)
    assert [side for _, side in runs] == [Side.UPPER, Side.LOWER]
    assert runs[1][0] == pytest.approx(1 + 1 / 1.5)


def test_arcs_of_a_saturated_swing_up_are_read_off_the_direct_solution(swing_up: Any) -> None:
    part = rt.indirect.costates(rt.plan(swing_up(force=12.0), rt.Mesh(60))).phases[0]
    arcs = find_arcs(part)
    assert [arc.sides[0] for arc in arcs] == [Side.INTERIOR, Side.LOWER, Side.INTERIOR]
    assert arcs[0].start == 0.0
    assert arcs[-1].end == 2.0
    assert (arcs[1].start, arcs[1].end) == (pytest.approx(0.781, abs=0.034), pytest.approx(0.920, abs=0.034))
