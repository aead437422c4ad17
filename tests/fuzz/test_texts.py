"""Hostile problem files, SRDFs and meshes in a guarded process: refused with one InputError, or read."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from guard import Guard
from texts import EXAMPLES, MESHES, PROBLEMS, good_mesh, hostile_mesh, hostile_problem, hostile_srdf

COUNT = int(os.environ.get("FUZZ_TEXTS", "40"))


def solved_once(kind: str, name: str, data: bytes, folder: Path, guard: Guard) -> str:
    path = folder / name
    path.write_bytes(data)
    verdict = guard.attempt(kind, str(path))
    return "" if verdict.right else f"{verdict.kind} {verdict.text}"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["problem", "srdf", "mesh"])
def test_hostile_texts_are_refused_or_harmless(kind: str, tmp_path: Path) -> None:
    wrong = {}
    with Guard(seconds=30.0) as guard:
        for seed in range(COUNT):
            suffix, data = {
                "problem": lambda seed: ("toml", hostile_problem(seed)),
                "srdf": lambda seed: ("srdf", hostile_srdf(seed)),
                "mesh": hostile_mesh,
            }[kind](seed)
            if fault := solved_once(kind, f"hostile.{suffix}", data, tmp_path, guard):
                wrong[seed] = fault
    assert not wrong


def test_what_is_not_changed_is_read(tmp_path: Path) -> None:
    with Guard(seconds=60.0) as guard:
        for name in PROBLEMS:
            verdict = guard.attempt("problem", str(EXAMPLES / name))
            assert verdict.kind == "loaded", verdict
        for suffix in MESHES:
            path = tmp_path / f"good.{suffix}"
            path.write_bytes(good_mesh(suffix))
            verdict = guard.attempt("mesh", str(path))
            assert verdict.kind == "loaded", (suffix, verdict)
