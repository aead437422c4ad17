"""Hostile models of MuJoCo in a guarded process: refused with one InputError or loaded, and nothing is left."""

from __future__ import annotations

import os
from pathlib import Path

from guard import Guard
from mjcf_files import GOOD, hostile_mjcf

COUNT = int(os.environ.get("FUZZ_MJCF", "150"))


def test_hostile_models_are_refused_or_harmless(tmp_path: Path) -> None:
    wrong, refused, path = {}, 0, tmp_path / "hostile.xml"
    with Guard() as guard:
        for seed in range(COUNT):
            path.write_bytes(hostile_mjcf(seed))
            verdict = guard.attempt("mjcf", str(path))
            refused += verdict.kind == "refused"
            if not verdict.right:
                wrong[seed] = verdict
    assert not wrong
    assert refused > COUNT // 4


def test_the_model_that_is_not_changed_loads(tmp_path: Path) -> None:
    (tmp_path / "good.xml").write_text(GOOD)
    with Guard(seconds=60.0) as guard:
        verdict = guard.attempt("mjcf", str(tmp_path / "good.xml"))
    assert verdict.kind == "loaded", verdict
