"""Obstacles of a file are those of ``rt.obstacles``; a mistake is named with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

import robotraj as rt
from robotraj.applications.problem_files.obstacles import load_obstacles

SCENE = """
[[obstacles]]
type = "Box"
sides = [0.2, 0.3, 0.4]
position = [0.5, 0.5, 0.1]

[[obstacles]]
type = "Sphere"
radius = 0.1
frame = "tool0"
"""


def written(folder: Path, text: str) -> Path:
    (folder / "scene.toml").write_text(text)
    return folder / "scene.toml"


def test_shapes_of_a_file_are_those_of_python(tmp_path: Path) -> None:
    box, ball = rt.obstacles.Box((0.2, 0.3, 0.4), position=(0.5, 0.5, 0.1)), rt.obstacles.Sphere(0.1, frame="tool0")
    assert load_obstacles(written(tmp_path, SCENE)) == (box, ball)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SCENE.replace("sides", "side"), r"scene.toml, line 4, .*'side'.*'sides'"),
        (SCENE.replace("Box", "Bax"), r"line 3, .*Bax.*Box"),
        (SCENE.replace("[[obstacles]]", "[[obstacle]]"), r"obstacle.*obstacles"),
        ("", r"has no obstacles: add \[\[obstacles\]\]"),
        ("[[obstacles]", r"line 1: this is no TOML"),
    ],
)
def test_mistakes_are_named_with_their_line(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match=message):
        load_obstacles(written(tmp_path, text))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match=r"file of obstacles.*scene.toml"):
        load_obstacles(tmp_path / "scene.toml")
