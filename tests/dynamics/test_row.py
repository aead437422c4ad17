"""Sizes of rows in a motion."""

from __future__ import annotations

from robotraj.dynamics.row import Row, changes_of


def held(name: str, unit: str) -> Row:
    return Row(name, unit, 0.0, 0.0)


def test_a_variable_that_is_held_at_zero_has_the_size_of_its_unit_not_of_its_own_error() -> None:
    rows = [held("qx", ""), Row("qy", "", -0.3, 0.3), held("q1", "rad"), Row("x", "m", 0.0, 1.0)]
    assert changes_of(rows, [4e-8, 1e-3, 1e-9, 0.2]) == [1e-3, 1e-3, 1e-9, 0.2]
