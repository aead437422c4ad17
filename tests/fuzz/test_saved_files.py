"""Hostile saved files in a guarded process: refused with one InputError or loaded, and nothing else happens."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from guard import Guard
from saved_files import good_files, hostile_file

COUNT = int(os.environ.get("FUZZ_FILES", "300"))

FOUND = (1689, 704970)
"""Seeds that failed once: a robot with a motor that no control drives, a solution without facts."""


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return good_files(tmp_path_factory.mktemp("good"))


def test_good_files_load_and_nothing_is_written(good: list[Path]) -> None:
    """A plan among obstacles once read its URDF again, and wrote fitted spheres into the cache."""
    with Guard() as guard:
        for path in good:
            verdict = guard.attempt("saved", str(path))
            assert verdict.kind == "loaded", (path.name, verdict)


@pytest.mark.slow
def test_hostile_files_are_refused_or_harmless(good: list[Path], tmp_path: Path) -> None:
    wrong, refused = {}, 0
    with Guard() as guard:
        for seed in (*FOUND, *range(COUNT)):
            path = tmp_path / "hostile.npz"
            path.write_bytes(hostile_file(seed, good))
            verdict = guard.attempt("saved", str(path))
            refused += verdict.kind == "refused"
            if not verdict.right:
                wrong[seed] = verdict
    assert not wrong
    assert refused > COUNT // 2
