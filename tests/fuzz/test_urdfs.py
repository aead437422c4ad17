"""Hostile URDFs in a guarded process: refused with one InputError or loaded, and nothing else happens."""

from __future__ import annotations

import os
from pathlib import Path

from guard import Guard
from urdfs import hostile_urdf, unchanged_urdf

COUNT = int(os.environ.get("FUZZ_URDFS", "200"))

FOUND = (551, 816, 1142, 708242)
"""Seeds that failed once: messages as long as an attribute of 100,000 characters, inertias whose sum overflows."""


def test_hostile_urdfs_are_refused_or_harmless(tmp_path: Path) -> None:
    wrong, refused = {}, 0
    with Guard() as guard:
        for seed in (*FOUND, *range(COUNT)):
            path = tmp_path / "hostile.urdf"
            path.write_bytes(hostile_urdf(seed))
            verdict = guard.attempt("urdf", str(path))
            refused += verdict.kind == "refused"
            if not verdict.right:
                wrong[seed] = verdict
    assert not wrong
    assert refused > COUNT // 2


def test_trees_that_are_not_changed_load(tmp_path: Path) -> None:
    with Guard() as guard:
        for seed in range(20):
            path = tmp_path / "good.urdf"
            path.write_bytes(unchanged_urdf(seed))
            verdict = guard.attempt("urdf", str(path))
            assert verdict.kind == "loaded", (seed, verdict)
