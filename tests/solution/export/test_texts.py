"""Names reach other programs as they are, and start nothing there."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.export.times import FORMULAS, cell, yaml_text

NAMES = ["=cmd|' /C calc'!A0", "+1+1", "-2", "@SUM(A1)", "\tx", "\r=1", " =1", "q", "joint 1", "é", "\U0001f916"]


@pytest.mark.parametrize("name", NAMES)
def test_no_cell_is_a_formula(name: str) -> None:
    assert not cell(name).lstrip(" ").startswith(FORMULAS)
    assert name in cell(name)


@pytest.mark.parametrize("name", [*NAMES, 'a"b\\', "no", "1e5", "a: b # c", "\x00\x1b\x7f\x85\u2028\ufeff", "{}[]"])
def test_yaml_reads_back_the_same_name(name: str) -> None:
    yaml = pytest.importorskip("yaml")
    assert yaml.safe_load(f"names: [{yaml_text(name)}]") == {"names": [name]}


def test_exports_of_hostile_names_are_written(tmp_path: Path) -> None:
    names = ["=1+1", "\ud800"]
    system = rt.System(names, ["@u"], lambda point: [point.x[names[1]], point.u["@u"]])
    phase = rt.Phase(system, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Lagrange(lambda point: point.u["@u"] ** 2))
    solution = rt.plan(phase, rt.Mesh(4))
    with solution.to_csv(tmp_path / "plan.csv").open(newline="", encoding="utf-8") as file:
        [headings, *rows] = list(csv.reader(file))
    assert not any(heading.startswith(FORMULAS) for heading in headings)
    assert np.isfinite(np.array(rows, dtype=float)).all()
    read = json.loads(solution.to_json(tmp_path / "plan.json").read_text(), parse_constant=pytest.fail)
    assert "=1+1" in " ".join(read["columns"])
