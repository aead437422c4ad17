"""The folder of a study may be a stranger's: its files are read, or refused by name, whatever they hold."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from tests.applications.studies.problems import OPTIONS, cases, make

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

SEEDS = int(os.environ.get("FUZZ_STUDIES", "40"))
MANY = 200_000
FIRST = "00000000.parquet"
"""It is read before the study's own files, whose names are random."""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("good") / "study"
    rt.sweep(make, cases(3), store=folder, keep="all", **OPTIONS)
    return folder


@pytest.fixture
def copy(study: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(study, tmp_path / "study"))


def read(folder: Path) -> None:
    """Read all that a user does, and go on with the study."""
    found = rt.Study(folder)
    _ = len(found), str(found), found.facts, found.missing, found.failures, found.figures, found.plot("seconds")
    for key in found.table.column("key").to_pylist():
        found.motion(key), found.solution(key, make({"T": 1.0}))
    str(found.regressions(found))
    rt.sweep(make, cases(3), store=folder, keep="all", **OPTIONS)


def changed(name: str, values: Callable[[int], object]) -> Callable[[Path], None]:
    """Return what replaces a column of the first file of rows."""

    def change(folder: Path) -> None:
        path = next(iter(sorted((folder / "rows").glob("*.parquet"))))
        table = parquet.read_table(path)
        parquet.write_table(table.set_column(table.column_names.index(name), name, values(table.num_rows)), path)

    return change


def put(table: Callable[[], object]) -> Callable[[Path], None]:
    return lambda folder: parquet.write_table(table(), folder / "rows" / FIRST, compression="zstd")


def bomb() -> object:
    """A few kilobytes that unpack to 100 GB of text."""
    text = pa.DictionaryArray.from_arrays(pa.array(np.zeros(MANY, np.int32)), pa.array(["m" * 500_000]))
    return pa.table({"key": pa.array([f"{i:x}" for i in range(MANY)]), "message": text})


HOSTILE = {
    "another path as a key": (changed("key", lambda n: pa.array(["../../../etc/passwd"] * n)), "hexadecimal"),
    "no key": (changed("key", lambda n: pa.array([None] * n, pa.string())), "hexadecimal"),
    "an endless key": (changed("key", lambda n: pa.array(["a" * 10**6] * n)), "hexadecimal"),
    "a short motion": (changed("q", lambda n: pa.array([[1.0] * 5] * n)), "has not 64 times of 'q'"),
    "another type": (changed("success", lambda n: pa.array([[1.0]] * n)), "damaged"),
    "few columns": (put(lambda: pa.table({"key": ["a"], "objective": [np.nan]})), "no column"),
    "another column": (put(lambda: pa.table({"key": ["a"], "__class__": ["a"]})), "damaged"),
    "texts of 100 GB": (put(bomb), "its texts have 100"),
    "many values": (put(lambda: pa.table({"key": ["a"], "t": [np.zeros(51 * 10**6, np.float32)]})), "values"),
    "a pipe": (lambda folder: os.mkfifo(folder / "rows" / FIRST), "is no regular file"),
    "a device": (lambda folder: (folder / "rows" / FIRST).symlink_to("/dev/zero"), "is no regular file"),
    "facts of 5000 digits": (lambda folder: (folder / "study.json").write_text('{"a":' + "9" * 5000 + "}"), "damaged"),
    "deep facts": (lambda folder: (folder / "study.json").write_text("[" * 100_000), "damaged"),
    "no cases": (lambda folder: (folder / "cases.parquet").write_bytes(b""), "damaged"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_by_name(copy: Path, name: str) -> None:
    change, message = HOSTILE[name]
    change(copy)
    with pytest.raises(rt.InputError, match=message):
        read(copy)


def test_a_key_that_is_given_is_no_path(study: Path) -> None:
    with pytest.raises(rt.InputError, match="is no key of a study"):
        rt.Study(study).solution("../../secret")


@pytest.mark.slow
def test_random_damage_is_read_or_refused(copy: Path) -> None:
    rng = np.random.default_rng(49)
    good = {path: path.read_bytes() for path in copy.rglob("*") if path.is_file() and path.suffix != ".npz"}
    for _ in range(SEEDS):
        path = list(good)[rng.integers(len(good))]
        data = bytearray(good[path])
        for _ in range(rng.integers(1, 6)):
            place = int(rng.integers(len(data)))
            data[place : place + int(rng.integers(1, 9))] = rng.bytes(int(rng.integers(0, 9)))
        path.write_bytes(data)
        try:
            read(copy)
        except rt.InputError as error:
            assert str(error)
        for kept, text in good.items():
            kept.write_bytes(text)
        for extra in set((copy / "rows").iterdir()) - set(good):
            extra.unlink()
