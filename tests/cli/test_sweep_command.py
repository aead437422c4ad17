"""``robotraj sweep`` plans the cases of a file that are missing, in parts if it is told so."""

from __future__ import annotations

from pathlib import Path

import pytest

import robotraj as rt
from tests.cli.shell import fail, succeed

pytest.importorskip("pyarrow")

STUDY = """
import robotraj as rt
block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
def make(case):
    ends = {"start": rt.State([0, 0]), "end": rt.State([1, 0])}
    return rt.Phase(block, duration=case["T"], objective=rt.Lagrange(lambda point: point.u["u"] ** 2), **ends)
cases = [{"T": 1.0 + 0.1 * i} for i in range(5)]
options = {"mesh": rt.Mesh(4)}
"""


def test_a_study_is_planned_in_parts_and_once(here: Path) -> None:
    Path("study.py").write_text(STUDY)
    output = succeed("sweep", "study.py", "--store", "moves", "--part", "1/2")
    assert "study of 5 plans" in output and "0 missing" in output and "solved: 5" in output
    files = sorted((here / "moves" / "rows").iterdir())
    succeed("sweep", "study.py", "--store", "moves", "--part", "0/2")
    assert sorted((here / "moves" / "rows").iterdir()) == files
    rows = rt.Study("moves").table.to_pylist()
    assert {round(row["objective"] * row["case_T"] ** 3, 6) for row in rows} == {12.0}


def test_wrong_parts_and_files_are_named(here: Path) -> None:
    Path("study.py").write_text(STUDY)
    Path("half.py").write_text("cases = []")
    assert "such as 3/200" in fail("sweep", "study.py", "--store", "moves", "--part", "three")
    assert "part 2 of 2 is none" in fail("sweep", "study.py", "--store", "moves", "--part", "2/2")
    assert "defines no 'make'" in fail("sweep", "half.py", "--store", "moves")
    assert "no file" in fail("sweep", "none.py", "--store", "moves")
