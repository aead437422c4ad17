"""Files of a study, and data sets of it, are written completely or not at all, whatever the disk does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robotraj as rt
from robotraj.applications.studies.cases import as_cases
from robotraj.applications.studies.store import Store
from tests.applications.studies.problems import OPTIONS, make
from tests.disk_faults import CALLS, fail_in_turn, full_disk

pytest.importorskip("pyarrow")

Writer = Callable[[rt.Study, Path], object]


def begun(study: rt.Study, folder: Path) -> None:
    """Begin a study of many cases, and write the rows of another one to it."""
    every = as_cases([{"T": 1.0 + 1e-3 * number} for number in range(300)], "digest")
    store = Store(folder, create=True)
    store.begin(every, {"digest": "digest"})
    store.add(study.table.to_pylist(), every)


WRITERS: dict[str, Writer] = {
    "store": begun,
    "set": lambda study, path: study.to_lerobot(path, 200, task="slide"),
    "set.hdf5": lambda study, path: study.to_robomimic(path, 200, name="slide"),
}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> rt.Study:
    cases = [{"T": 1.0 + 0.1 * number} for number in range(4)]
    return rt.sweep(make, cases, store=tmp_path_factory.mktemp("files") / "store", **OPTIONS)


def written(folder: Path) -> list[str]:
    """Files of a folder, without the names of rows."""
    every = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return sorted(str(path.parent if path.parent.name == "rows" else path) for path in every)


@pytest.mark.parametrize("name", WRITERS)
def test_a_full_disk_is_an_error_that_says_so_and_leaves_nothing_half(
    name: str, study: rt.Study, tmp_path: Path
) -> None:
    if name == "set.hdf5":
        pytest.importorskip("h5py")
    with full_disk(), pytest.raises(rt.InputError, match="could not be written: .*Nothing of it was kept"):
        WRITERS[name](study, tmp_path / name)
    assert written(tmp_path) in ([], ["store/cases.parquet", "store/study.json"])
    WRITERS[name](study, tmp_path / name)
    assert len(written(tmp_path)) in (1, 3, 5)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("call", CALLS, ids=lambda call: f"{call[0].__name__}.{call[1]}")
def test_whatever_call_fails_all_is_there_or_an_error_says_what_is_not(
    name: str, call: tuple[Any, str], study: rt.Study, tmp_path: Path
) -> None:
    if name == "set.hdf5":
        pytest.importorskip("h5py")
    whole = tmp_path / "whole"
    whole.mkdir()
    WRITERS[name](study, whole / name)
    number = 0

    def folder() -> Path:
        return tmp_path / str(number)

    def prepared() -> None:
        nonlocal number
        number += 1
        folder().mkdir()

    def judged(error: rt.InputError | None) -> None:
        found = written(folder())
        if error is None or "is whole" in str(error):
            assert name == "store" or found == written(whole)
        elif name == "store":
            assert set(found) < set(written(whole)) or call[1] in ("open", "rmdir", "unlink")
        else:
            assert found == [] or call[1] in ("open", "rmdir", "unlink")
        assert error is None or str(folder()) in str(error)

    fail_in_turn(call, tmp_path, lambda: WRITERS[name](study, folder() / name), prepared, judged)
