"""The lecture's experiment draws its figures from our own data."""

from __future__ import annotations

from pathlib import Path

import lecture
import numpy as np
import pytest
from matplotlib.image import imread


@pytest.mark.slow
def test_figures_3_to_10_are_drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lecture, "RUNS", 1)
    lecture.main([])
    names = [f"lecture_{number:02d}.png" for number in range(3, 11)]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    pictures = [imread(name)[..., :3] for name in names]
    assert all(np.ptp(picture) > 0.5 and picture.mean() < 0.99 for picture in pictures)


def test_the_exact_motion_is_at_rest_at_both_ends_and_fastest_at_its_switch() -> None:
    total = lecture.optimum()
    x, v, u = lecture.exact(np.array([0.0, 0.5 * total - 1e-9, 0.5 * total + 1e-9, total]))
    assert x == pytest.approx([0, 5, 5, 10], abs=1e-7)
    assert v == pytest.approx([0, np.sqrt(10), np.sqrt(10), 0], abs=1e-7)
    assert list(u) == [1, 1, -1, -1]
