"""The palette of the page: contrast on both papers, and colours that stay apart without red or green."""

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import robotraj.replay_page as room
from robotraj.replay_page.colors import RGB, css, palette

LINEAR_TO_LMS = np.array(
    [[0.31399022, 0.63951294, 0.04649755], [0.15537241, 0.75789446, 0.08670142], [0.01775239, 0.10944209, 0.87256922]]
)
"""Linear RGB to responses of the cones (Hunt, Pointer and Estevez)."""
MISSING = {
    "protanopia": np.array([[0, 1.05118294, -0.05116099], [0, 1, 0], [0, 0, 1]]),
    "deuteranopia": np.array([[1, 0, 0], [0.9513092, 0, 0.04866992], [0, 0, 1]]),
}
"""Projections for missing cones (Vienot, Brettel and Mollon, 1999)."""


def linear(rgb: object) -> np.ndarray:
    c = np.asarray(rgb, dtype=float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def luminance(rgb: object) -> float:
    return float(linear(rgb) @ [0.2126, 0.7152, 0.0722])


def papers() -> list[tuple[float, ...]]:
    text = (Path(room.__file__).parent / "web" / "styles" / "themes.css").read_text()
    found = re.findall(r"--paper: #(\w\w)(\w\w)(\w\w)", text)
    return [tuple(int(part, 16) / 255 for part in parts) for parts in found]


def test_every_colour_is_seen_on_both_papers() -> None:
    assert len(papers()) == 2
    for color in RGB:
        for paper in papers():
            high, low = sorted((luminance(color), luminance(paper)), reverse=True)
            assert (high + 0.05) / (low + 0.05) >= 3.0, (color, paper)


def seen(rgb: object, projection: np.ndarray) -> np.ndarray:
    """Linear RGB as an eye sees it that lacks one kind of cone."""
    back = np.linalg.inv(LINEAR_TO_LMS)
    return np.clip(back @ projection @ LINEAR_TO_LMS @ linear(rgb), 0.0, 1.0)


def lab(rgb: np.ndarray) -> np.ndarray:
    xyz = (
        np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
        @ rgb
        / [0.9505, 1, 1.089]
    )
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("kind", MISSING)
def test_neighbours_stay_apart_without_one_kind_of_cone(kind: str) -> None:
    drawn = [lab(seen(color, MISSING[kind])) for color in RGB]
    for a, b in combinations(range(4), 2):
        # A difference of 10 is seen at a glance; dashes tell the others apart.
        assert np.linalg.norm(drawn[a] - drawn[b]) > 10.0, (css(a), css(b))


def test_the_palette_repeats() -> None:
    assert len(palette()) == len(RGB) == len(set(palette()))
    assert css(len(RGB)) == css(0)
