"""Two studies of the same cases: what became worse is found, whatever the keys, and what became better is not."""

from __future__ import annotations

from pathlib import Path

import pytest

import robotraj as rt
from robotraj.applications.studies.cases import as_cases
from robotraj.applications.studies.store import Store
from tests.cli.shell import run

pytest.importorskip("pyarrow")


def study(folder: Path, rows: dict[str, dict[str, object]]) -> rt.Study:
    """Write a study of the rows, by name of their case."""
    good = {"status": "solved", "success": True, "proved": True, "objective": 2.0, "duration": 1.0, "seconds": 0.1}
    cases = as_cases([{"name": name} for name in rows], str(folder))
    store = Store(folder, create=True)
    store.begin(cases, {})
    keys = zip(cases.by_key, rows.items(), strict=True)
    store.add([{"key": key, "case_name": name, **(good | row)} for key, (name, row) in keys], cases)
    return rt.Study(folder)


CHANGES: dict[str, dict[str, object]] = {
    "same": {},
    "lost": {"success": False, "status": "infeasible"},
    "unproved": {"proved": False},
    "longer": {"duration": 1.1},
    "costlier": {"objective": 2.2},
    "slower": {"seconds": 0.3},
    "faster": {"seconds": 0.01, "objective": 1.0, "duration": 0.5},
    "a little slower": {"seconds": 0.12},
}


def test_each_case_that_became_worse_is_named_by_how(tmp_path: Path) -> None:
    before = study(tmp_path / "before", dict.fromkeys([*CHANGES, "gone"], {}))
    after = study(tmp_path / "after", CHANGES)
    found = after.regressions(before)
    assert {each.case["name"]: each.kind for each in found.found} == {
        kind: kind for kind in ("lost", "unproved", "longer", "costlier", "slower")
    }
    assert found and found.unsafe and (found.compared, found.missing) == (8, 1)
    assert {each.kind for each in found.found[:2]} == {"lost", "unproved"} and "infeasible" in str(found)
    assert not before.regressions(before) and not before.regressions(after).unsafe
    assert len(after.regressions(before, slower=1.1).found) == 6


@pytest.mark.parametrize(("change", "code"), [("same", 0), ("slower", 1), ("unproved", 4), ("lost", 4)])
def test_the_exit_code_tells_a_lost_plan_from_a_slow_one(change: str, code: int, tmp_path: Path) -> None:
    study(tmp_path / "before", {"one": {}})
    study(tmp_path / "after", {"one": CHANGES[change]})
    result = run("compare", tmp_path / "before", tmp_path / "after")
    assert result.exit_code == code and "1 cases compared" in result.stdout


def test_studies_without_a_common_case_are_refused(tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match="no case in common"):
        study(tmp_path / "a", {"one": {}}).regressions(study(tmp_path / "b", {"two": {}}))
