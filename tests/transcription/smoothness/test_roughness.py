"""The height of teeth: curves that alternate with the mesh, on meshes of any grading."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robotraj._util.curves.teeth import teeth
from robotraj.transcription.smoothness.roughness import rough_intervals, roughness

KNOTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))
TIMES = np.sort(np.append(KNOTS, 0.5 * (KNOTS[1:] + KNOTS[:-1])))
ALTERNATING = np.where(np.arange(len(TIMES)) % 2, -1.0, 1.0)


@pytest.mark.parametrize("height", [0.5, 3.0])
def test_teeth_on_a_straight_line_have_their_own_height(height: float) -> None:
    curves = np.stack([2.0 - TIMES + 0.5 * height * ALTERNATING, np.zeros(len(TIMES))], axis=1)
    assert teeth(TIMES, curves) == pytest.approx([height, 0.0], rel=0.02, abs=1e-12)


def test_teeth_of_one_side_count_as_well() -> None:
    """Scallops hang from the knots; every middle is low."""
    scallops = np.where(ALTERNATING > 0.0, 0.0, -0.7)
    assert teeth(TIMES, scallops[:, None]) == pytest.approx(0.7, rel=0.02)


@pytest.mark.parametrize(
    "curve",
    [
        lambda t: np.where(t < 0.5, 1.0, -1.0),
        lambda t: np.where((t > 0.4) & (t < 0.5), 1.0, -1.0),
        lambda t: np.where(np.abs(t - 0.5) < 0.01, 1.0, 0.0),
        lambda t: np.sin(4.0 * np.pi * t),
        lambda t: np.abs(t - 0.3),
    ],
)
def test_switches_spikes_and_smooth_curves_have_no_teeth(curve: object) -> None:
    assert teeth(TIMES, curve(TIMES)[:, None])[0] < 0.01  # type: ignore[operator]


def test_few_points_have_no_teeth() -> None:
    assert np.all(teeth(TIMES[:9], ALTERNATING[:9, None]) == 0.0)


def test_teeth_are_found_on_the_intervals_that_have_them() -> None:
    """Intervals 10 to 19 of 40 have teeth of a tenth of the limit; those a window away from them have none."""
    knots = np.linspace(0.0, 1.0, 41)
    inside = np.zeros((40, 3, 1))
    inside[10:20, 1] = 0.2
    phase = SimpleNamespace(
        dae=SimpleNamespace(controls=("u",)),
        rows=SimpleNamespace(limits_of=lambda controls: (np.array([-2.0]), np.array([2.0]))),
    )
    motion = SimpleNamespace(x=SimpleNamespace(breaks=knots))
    inputs = SimpleNamespace(inside=lambda places: (None, inside))
    found = rough_intervals(phase, motion, inputs)  # type: ignore[arg-type]
    assert found[11:19] == pytest.approx(0.1, rel=0.02)
    assert found.max() == pytest.approx(roughness(phase, motion, inputs).max())  # type: ignore[arg-type]
    assert np.all(found[:8] == 0.0) and np.all(found[23:] == 0.0)
