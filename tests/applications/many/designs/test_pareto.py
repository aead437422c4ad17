"""A front meets its closed form, and its points are spread."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.applications import pareto

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


def move(weight: float) -> rt.Phase:
    """Effort and duration of a motion over 1 m: effort = 12 / T^3."""
    return rt.Phase(
        BLOCK,
        (0.2, 20.0),
        rt.State([0, 0]),
        rt.State([1, 0]),
        rt.Lagrange(lambda point: point.u["u"] ** 2) + weight * rt.Duration(),
    )


def test_a_front_is_its_closed_form_with_gaps_alike() -> None:
    """Weights spread evenly, or by their logarithm, leave gaps of more than half of the front."""
    front = pareto(move, (0.1, 1000.0), points=9, mesh=rt.Mesh(6))
    assert len(front.points) == 9
    for point in front.points:
        assert point.second == pytest.approx((36.0 / point.weight) ** 0.25, rel=1e-4)
        assert point.first == pytest.approx(12.0 / point.second**3, rel=1e-3)
    assert np.all(np.diff([point.first for point in front.points]) > 0.0)
    assert front.largest_gap < 0.3
    assert "9 points" in str(front) and front.plot().axes


def test_a_front_of_one_point_ends() -> None:
    """With a fixed duration the weight changes nothing."""

    def fixed(weight: float) -> rt.Phase:
        return move(weight).with_(duration=1.0)

    front = pareto(fixed, (0.1, 10.0), points=6, mesh=rt.Mesh(4))
    assert len(front.points) <= 3 and front.points[0].first == pytest.approx(12.0, rel=1e-6)


@pytest.mark.parametrize("weights", [(0.0, 1.0), (2.0, 1.0), (1.0, np.inf), 3.0])
def test_wrong_weights_are_named(weights: object) -> None:
    with pytest.raises(rt.InputError, match="0 < low < high"):
        pareto(move, weights)  # type: ignore[arg-type]
