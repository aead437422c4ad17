"""Benchmarks that use internals of the solver still run, on meshes that are too small to measure anything."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def linearity(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import linearity

    monkeypatch.setattr(linearity, "ARM", (2, 4, 8))
    monkeypatch.setattr(linearity, "CARTPOLE", (5, 10, 20))
    monkeypatch.setattr(linearity, "RUNS", 1)
    return linearity


def test_linearity_reports_every_mesh(linearity: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    linearity.by_ipopt()
    linearity.by_stages()
    linearity.in_fresh_processes()
    printed = capsys.readouterr().out
    assert printed.count("worst distance from the line") == 4
    lines = [line.split() for line in printed.splitlines() if line.endswith("%") and line.split()[0].isdigit()]
    assert [int(line[0]) for line in lines] == [5, 10, 20] + 3 * [2, 4, 8]
    assert all(float(line[1]) > 0 for line in lines)


def test_the_nearest_line_leaves_equal_distances(linearity: ModuleType) -> None:
    n = np.array([1.0, 2.0, 4.0])
    seconds = 3 + 2 * n + np.array([0.0, 1.0, 0.0])
    at_zero, slope = linearity.nearest_line(n, seconds)
    off = (at_zero + slope * n) / seconds - 1
    np.testing.assert_allclose(np.abs(off), np.max(np.abs(off)), rtol=1e-6)
    np.testing.assert_allclose(linearity.nearest_line(n, 3 + 2 * n), [3, 2], rtol=1e-8)


@pytest.mark.slow
def test_roofline_reports_every_mesh_and_robot(
    linearity: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    roofline = sys.modules["roofline"]
    table = tmp_path / "roofline.md"
    table.write_text(roofline.TABLE.read_text())
    monkeypatch.setattr(roofline, "TABLE", table)
    monkeypatch.setattr(roofline, "INTERVALS", (2, 4))
    monkeypatch.setattr(roofline, "MESH", 3)
    monkeypatch.setattr(roofline, "RUNS", 1)
    monkeypatch.setattr(roofline, "ROBOTS", {name: roofline.ROBOTS[name] for name in ("ur5", "panda", "solo12")})
    roofline.main()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in capsys.readouterr().out.splitlines()]
    arm, robots = ([row for row in rows if len(row) == cells][2:] for cells in (7, 8))
    assert [row[0] for row in arm] == ["2", "4"]
    assert {row[0]: int(row[1]) for row in robots} == {
        name: rt.load(name, **settings).nu for name, settings in roofline.ROBOTS.items()
    }
    assert all(float(cell) > 0 for row in arm + robots for cell in row[-3:])


@pytest.mark.parametrize("name", ["five_link", "two_link_arm", "cartpole"])
def test_the_independent_reader_of_robots_agrees_with_the_loader_and_notices_another_mass(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS / "robots"))
    import one_file

    robot, path = rt.load(name), find(name).urdf
    assert one_file.agreement(robot, path, np.random.default_rng(0)) < one_file.LARGEST_SHARE
    heavier = tmp_path / "heavier.urdf"
    heavier.write_text(path.read_text().replace('<mass value="', '<mass value="1'))
    assert heavier.read_text() != path.read_text()
    assert one_file.agreement(robot, heavier, np.random.default_rng(0)) > 1e-2


def test_the_table_of_constants_has_those_of_the_files(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import constants

    lines = constants.TABLE.read_text().splitlines()
    rows = [tuple(cell.strip() for cell in line.split("|")[1:3]) for line in lines if line.startswith("| planning/")]
    trees = [(file, ast.parse((constants.PACKAGE / file).read_text())) for file in constants.FILES]
    known = [(f"{file} {name}", ast.unparse(v)) for file, tree in trees for name, v in constants._constants(tree)]
    assert rows == known
