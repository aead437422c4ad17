import numpy as np
import pytest

from robotraj.replay_page.charts.curves import curves as curves_of
from robotraj.solution.cycles.gait_cycles import gait_cycles


def curves(plan):
    return curves_of(gait_cycles(plan))


def test_a_jump_at_a_knot_shows_both_sides(block_plan):
    states, controls = curves(block_plan)
    piece = controls["pieces"][0]
    at_knot = [u for t, u in zip(piece["t"], piece["y"][0], strict=True) if t == 1.0]
    assert at_knot == [1.0, -1.0]
    assert states["continuous"] and not controls["continuous"]
    assert states["series"] == [
        {"label": "x", "unit": "m", "variable": "x"},
        {"label": "v", "unit": "m/s", "variable": "v"},
    ]
    assert states["pieces"][0]["y"][0][-1] == pytest.approx(1.0)


def test_limits_are_the_tightest_of_the_rows_that_hold_throughout(block_plan):
    states, controls = curves(block_plan)
    assert (controls["pieces"][0]["lower"], controls["pieces"][0]["upper"]) == ([-1.0], [0.9])
    assert (states["pieces"][0]["lower"], states["pieces"][0]["upper"]) == ([None, None], [None, 3.0])


def test_a_robot_has_three_charts_in_joint_order(ur5, wave_plan):
    plan = wave_plan(ur5, 2.0)
    charts = curves(plan)
    assert [c["symbol"] for c in charts] == ["q", "v", "τ"]
    units = [["rad"] * 6, ["rad/s"] * 6, ["N m"] * 6]
    for chart, unit in zip(charts, units, strict=True):
        assert [s["label"] for s in chart["series"]] == list(ur5.joint_names)
        assert [s["unit"] for s in chart["series"]] == unit
    piece = charts[0]["pieces"][0]
    expected = plan.phases[0].at(np.array(piece["t"])).q.T
    np.testing.assert_allclose(piece["y"], expected, rtol=1e-5, atol=1e-8)
    np.testing.assert_allclose(piece["upper"], ur5.limits.position_upper)


def test_each_phase_is_its_own_piece(ur5, wave_plan):
    for chart in curves(wave_plan(ur5, 3.0, phases=3)):
        assert [p["t"][0] for p in chart["pieces"]] == pytest.approx([0.0, 1.0, 2.0])
        assert [p["t"][-1] for p in chart["pieces"]] == pytest.approx([1.0, 2.0, 3.0])
        assert [len(p["y"]) for p in chart["pieces"]] == [6, 6, 6]


def test_what_is_not_a_number_becomes_a_gap(block_plan):
    read = block_plan.phases[0].read

    def broken(t, interval=None):
        sample = read(t, interval)
        sample.u = {"u": np.where(t < 0.5, np.nan, sample.u["u"])}
        return sample

    block_plan.phases[0].read = broken
    values = curves(block_plan)[1]["pieces"][0]["y"][0]
    assert values[0] is None
    assert values[-1] == -1.0
