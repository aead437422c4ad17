"""Files are written completely or not at all: an older file is kept, and the error reports it."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import robotraj as rt

WRITERS: dict[str, Callable[[rt.Solution, Path], Path]] = {
    "plan.npz": lambda solution, path: solution.save(path),
    "plan.csv": lambda solution, path: solution.to_csv(path),
    "plan.json": lambda solution, path: solution.to_json(path),
    "plan.html": lambda solution, path: rt.replay(solution, path),
}


@pytest.fixture(scope="module")
def solution() -> rt.Solution:
    phase = rt.Phase(rt.load("cartpole"), 2.0, rt.State(q=0, v=0), rt.State(q=[1, 3.14], v=0), rt.Effort())
    return rt.plan(phase, mesh=rt.Mesh(10))


@contextmanager
def full_disk() -> Iterator[None]:
    """Let no file grow above 4 kB."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


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
