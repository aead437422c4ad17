"""Caches are in the folder that the XDG specification names; paths of no file are clear errors."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robotraj as rt
from robotraj._util.paths import cache_folder, input_path, output_path


def test_the_folder_of_caches_is_the_one_of_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder("engines") == tmp_path / "robotraj" / "engines"


@pytest.mark.parametrize("ignored", ["", "relative"])
def test_a_relative_folder_in_the_environment_is_ignored(monkeypatch: pytest.MonkeyPatch, ignored: str) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", ignored)
    assert cache_folder("spheres") == Path.home() / ".cache" / "robotraj" / "spheres"


READERS: dict[str, Callable[[Any], object]] = {
    "robot": rt.load,
    "solution": rt.load_solution,
    "problem file": rt.load_problem,
    "study": rt.Study,
    "mesh": rt.obstacles.ConvexMesh.from_file,
    "SRDF": lambda path: rt.CollisionFree([rt.obstacles.Sphere(0.1)], srdf=path),
}
NO_PATHS = (
    "n" * 300,
    "a/" * 3000,
    "a\0b.npz",
    "",
    "/",
    "\ud800.npz",
    "loop.npz",
    "~nobody-there/a.npz",
    3,
    ["a"],
)


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("path", NO_PATHS, ids=lambda path: repr(path)[:12])
def test_what_is_no_path_of_a_file_is_an_error_that_says_so(
    reader: str, path: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop.npz").symlink_to("loop.npz")
    if reader == "study":
        pytest.importorskip("pyarrow")
    with pytest.raises(rt.InputError) as error:
        READERS[reader](path)
    assert len(str(error.value)) < 1500


def test_a_path_is_named_in_the_message() -> None:
    with pytest.raises(
        rt.InputError, match=r"The saved solution is 'n{10,}\.\.\.', which is no path of a file: File name"
    ):
        rt.load_solution(Path("n" * 300))


@pytest.mark.parametrize("reader", ["robot", "solution", "problem file"])
def test_a_device_is_named_as_what_it_is(reader: str) -> None:
    with pytest.raises(rt.InputError, match="is no regular file"):
        READERS[reader]("/dev/zero")


def test_a_disk_that_fails_is_no_fault_of_the_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object, **__: object) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO), "plan.npz")

    path = tmp_path / "plan.npz"
    monkeypatch.setattr(os, "stat", failing)
    with pytest.raises(rt.InputError, match=r"plan.npz', which cannot be read: Input/output error\.$"):
        input_path(path, "The saved solution")
    with pytest.raises(rt.InputError, match=r"plan.npz', which cannot be written: Input/output error\.$"):
        output_path(path, (".npz",), "the saved solution")
