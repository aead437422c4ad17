"""Caches are in the folder that the XDG specification names."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotraj._util.paths import cache_folder


def test_the_folder_of_caches_is_the_one_of_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder("engines") == tmp_path / "robotraj" / "engines"


@pytest.mark.parametrize("ignored", ["", "relative"])
def test_a_relative_folder_in_the_environment_is_ignored(monkeypatch: pytest.MonkeyPatch, ignored: str) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", ignored)
    assert cache_folder("spheres") == Path.home() / ".cache" / "robotraj" / "spheres"
