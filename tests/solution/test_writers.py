"""Files are written completely or not at all: an older file is kept, and the error reports it."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import robotraj as rt
from tests.disk_faults import CALLS, fail_in_turn, full_disk

CONTROLLERS = ".yaml", ".json", ".csv", ".servo", *([".mcap"] if find_spec("mcap") else [])
WRITERS: dict[str, Callable[[rt.Solution, Path], Path]] = {
    "plan.npz": lambda solution, path: solution.save(path),
    "plan.csv": lambda solution, path: solution.to_csv(path),
    "plan.json": lambda solution, path: solution.to_json(path),
    "plan.html": lambda solution, path: rt.replay(solution, path),
    **{f"motors{suffix}": lambda solution, path: solution.to_controller(path, 200.0) for suffix in CONTROLLERS},
}


@pytest.fixture(scope="module")
def solution() -> rt.Solution:
    phase = rt.Phase(rt.load("cartpole"), 2.0, rt.State(q=0, v=0), rt.State(q=[1, 3.14], v=0), rt.Effort())
    return rt.plan(phase, mesh=rt.Mesh(10))


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("older", [False, True], ids=["new", "older"])
def test_nothing_half_written_is_left_on_a_full_disk(
    name: str, older: bool, solution: rt.Solution, tmp_path: Path
) -> None:
    target = tmp_path / name
    if older:
        target.write_text("older")
    with full_disk(), pytest.raises(rt.InputError, match=f"{name}' could not be written: .*Nothing of it was kept"):
        WRITERS[name](solution, target)
    assert [path.name for path in tmp_path.iterdir()] == ([name] if older else [])
    assert not older or target.read_text() == "older"
    assert WRITERS[name](solution, target).stat().st_size > 4096
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("call", CALLS, ids=lambda call: f"{call[0].__name__}.{call[1]}")
def test_whatever_call_fails_the_old_file_or_the_new_one_is_there(
    name: str, call: tuple[Any, str], solution: rt.Solution, tmp_path: Path
) -> None:
    target = tmp_path / name

    def judged(error: rt.InputError | None) -> None:
        data = target.read_bytes()
        assert len(data) > 1000 or (data == b"older" and error is not None)
        if error is not None:
            assert name in str(error)
            assert ("is whole" in str(error)) == (data != b"older")
        if len(data) > 1000 and name.endswith(".npz"):
            assert rt.load_solution(target).objective == solution.objective
        assert call[1] in ("rmdir", "unlink", "open") or [path.name for path in tmp_path.iterdir()] == [name]

    fail_in_turn(call, tmp_path, lambda: WRITERS[name](solution, target), lambda: target.write_text("older"), judged)


def test_permissions_and_links_stay(solution: rt.Solution, tmp_path: Path) -> None:
    private, link = tmp_path / "private.npz", tmp_path / "link.npz"
    private.write_text("older")
    private.chmod(0o600)
    link.symlink_to(private)
    solution.save(link)
    assert link.is_symlink() and stat.S_IMODE(private.stat().st_mode) == 0o600
    assert rt.load_solution(private).objective == solution.objective
    assert {path.name for path in tmp_path.iterdir()} == {"private.npz", "link.npz"}


def test_a_loop_of_links_is_refused_and_stays(solution: rt.Solution, tmp_path: Path) -> None:
    loop = tmp_path / "loop.csv"
    loop.symlink_to(loop)
    with pytest.raises(rt.InputError, match="Too many levels of symbolic links"):
        solution.to_csv(loop)
    assert loop.is_symlink() and [path.name for path in tmp_path.iterdir()] == ["loop.csv"]


def test_a_name_may_have_255_bytes(solution: rt.Solution, tmp_path: Path) -> None:
    assert solution.save(tmp_path / f"{'n' * 251}.npz").exists()
    with pytest.raises(rt.InputError, match="choose a shorter name"):
        solution.save(tmp_path / f"{'n' * 252}.npz")


def test_a_pipe_is_not_replaced(solution: rt.Solution, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(rt.InputError, match="is no regular file"):
        solution.to_csv(tmp_path / "pipe.csv")
    assert stat.S_ISFIFO((tmp_path / "pipe.csv").stat().st_mode)


def test_the_file_is_on_the_disk_before_it_takes_its_place(
    solution: rt.Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda number: (done.append("disk"), fsync(number)))
    monkeypatch.setattr(os, "replace", lambda *paths: (done.append("place"), replace(*paths)))
    solution.save(tmp_path / "plan.npz")
    assert done == ["disk", "place", "disk"]
