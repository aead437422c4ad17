"""Exported tables contain the values of the solution, with units, at the given times."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from tests.robots.cartpole import swing_up


@pytest.fixture(
    scope="module", params=[rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()], ids=["inverse", "forward"]
)
def cartpole(request: pytest.FixtureRequest) -> rt.Solution:
    phase = swing_up(dynamics=request.param)
    return rt.plan(phase, rt.Mesh(20))


@pytest.fixture(scope="module")
def two_phases() -> rt.Solution:
    """One phase with a control, then one without any."""
    push = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], units={"x": "m", "v": "m/s", "u": "N"})
    coast = rt.System(["x", "v"], (), lambda p: [p.x["v"], 0.0 * p.x["v"]], units={"x": "m", "v": "m/s"})
    first = rt.Phase(
        push,
        duration=1.0,
        start=rt.State({"x": 0, "v": 0}),
        controls={"u": rt.between(-1, 1)},
        parameters={"mass": 2.0},
        name="push",
    )
    second = rt.Phase(coast, duration=2.0, end=rt.State({"x": 1.5}), name="coast")
    return rt.plan(rt.Problem([first, second], [rt.Continuity(0, 1)]), rt.Mesh(4))


def rows_of(path: Path) -> tuple[list[str], list[list[str]]]:
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return header, rows


def test_a_csv_has_names_units_and_all_digits(cartpole: rt.Solution, tmp_path: Path) -> None:
    path = cartpole.to_csv(tmp_path / "swing.csv", samples=33)
    header, rows = rows_of(path)
    assert header == [
        "t [s]",
        "q.slider [m]",
        "q.pole [rad]",
        "v.slider [m/s]",
        "v.pole [rad/s]",
        "a.slider [m/s^2]",
        "a.pole [rad/s^2]",
        "tau.slider [N]",
    ]
    table = np.array(rows, dtype=float)
    times = np.linspace(0, 2, 33)
    sample = cartpole.at(times)
    assert np.array_equal(table, np.column_stack([times, sample.q, sample.v, sample.a, sample.tau]))


def test_times_can_be_given(cartpole: rt.Solution, tmp_path: Path) -> None:
    times = [0.0, 0.123, 2.0]
    _, rows = rows_of(cartpole.to_csv(tmp_path / "swing.csv", samples=times))
    assert [float(row[0]) for row in rows] == times
    assert [float(row[2]) for row in rows] == cartpole.at(np.array(times)).q[:, 1].tolist()  # type: ignore[index]


def test_a_json_contains_the_whole_solution(cartpole: rt.Solution, tmp_path: Path) -> None:
    data = json.loads(cartpole.to_json(tmp_path / "swing.json", samples=11).read_text())
    assert data["status"] == "solved" and data["success"] is True
    assert data["objective"] == cartpole.objective and data["duration"] == 2.0
    assert data["iterations"] == cartpole.iterations and data["violations"] == []
    assert data["phases"][0]["name"] == "swing-up" and data["phases"][0]["subject"] == "cartpole"
    assert data["phases"][0]["knots"] == cartpole.knots.tolist()
    assert data["units"]["v.pole"] == "rad/s"
    assert list(data["columns"]) == list(data["units"])
    assert {len(column) for column in data["columns"].values()} == {11}
    assert data["columns"]["tau.slider"] == cartpole.at(np.linspace(0, 2, 11)).tau[:, 0].tolist()  # type: ignore[index]


def test_a_phase_without_a_variable_leaves_it_empty(two_phases: rt.Solution, tmp_path: Path) -> None:
    header, rows = rows_of(two_phases.to_csv(tmp_path / "two.csv", samples=[0.5, 1.0, 2.0]))
    control = [row[header.index("u [N]")] for row in rows]
    assert control[0] != "" and control[1:] == ["", ""]
    data = json.loads(two_phases.to_json(tmp_path / "two.json", samples=[0.5, 2.0]).read_text())
    assert data["columns"]["u"][1] is None and data["columns"]["x"][1] is not None
    assert data["parameters"] == {"mass": 2.0}
    assert [phase["start"] for phase in data["phases"]] == [0.0, pytest.approx(1.0)]


def test_a_failed_solution_is_exported_with_its_violations(tmp_path: Path) -> None:
    system = rt.System(["x"], ["u"], lambda p: [p.u["u"]], name="integrator")
    phase = rt.Phase(system, 1.0, start=rt.State({"x": 0}), end=rt.State({"x": 5}), controls={"u": rt.between(-1, 1)})
    solution = rt.plan(phase, rt.Mesh(3), check=False)
    data = json.loads(solution.to_json(tmp_path / "failed.json").read_text())
    assert data["success"] is False and data["status"] == solution.status.value
    assert data["violations"] == [str(violation) for violation in solution.violation_list] != []


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (1, "samples must be a whole number from 2"),
        (True, "samples must be a whole number from 2"),
        (10**13, "samples must be a whole number from 2"),
        ([[0.0, 1.0]], "list of times"),
        ([], "list of times"),
        ([0.0, 3.5], "t = 3.5 s lies outside"),
        ([-0.1, 1.0], "t = -0.1 s lies outside"),
        ([np.nan], "list of times"),
    ],
)
def test_samples_that_cannot_be_are_refused(
    two_phases: rt.Solution, tmp_path: Path, samples: Any, message: str
) -> None:
    with pytest.raises(rt.InputError, match=message):
        two_phases.to_csv(tmp_path / "a.csv", samples=samples)
    assert not (tmp_path / "a.csv").exists()


@pytest.mark.parametrize("rate", [1e12, 1e308, np.inf, np.nan, -1.0, 0.0])
def test_rates_that_fill_a_disk_or_are_none_are_refused(two_phases: rt.Solution, tmp_path: Path, rate: float) -> None:
    with pytest.raises(rt.InputError, match="rate"):
        two_phases.to_csv(tmp_path / "a.csv", rate=rate)
    assert not (tmp_path / "a.csv").exists()


def test_a_missing_directory_is_refused(two_phases: rt.Solution, tmp_path: Path) -> None:
    for write in (two_phases.to_csv, two_phases.to_json):
        with pytest.raises(rt.InputError, match="does not exist; create it"):
            write(tmp_path / "absent" / "a")
        with pytest.raises(rt.InputError, match="is a directory"):
            write(tmp_path)
