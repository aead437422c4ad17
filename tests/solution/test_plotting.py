"""Figures show every variable with its unit and limits, knots and collocation points where they are."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import robotraj as rt
from tests.robots.cartpole import swing_up


def plan(phase: rt.Phase, *mesh: Any, **options: Any) -> rt.Solution:
    return rt.plan(phase, rt.Mesh(*mesh), **options)


def block(**changes: Any) -> rt.Phase:
    system = rt.System(
        ["x", "v"],
        ["u"],
        lambda point: [point.x["v"], point.u["u"]],
        units={"x": "m", "v": "m/s", "u": "N"},
        name="block",
    )
    known: dict[str, Any] = {
        "duration": (0.1, 20),
        "start": rt.State({"x": 0, "v": 0}),
        "end": rt.State({"x": 10, "v": 0}),
        "states": {"v": rt.between(None, 2)},
        "controls": {"u": rt.between(-1, 1)},
        "objective": rt.Duration(),
    }
    return rt.Phase(system, **(known | changes))


@pytest.fixture(scope="module")
def cartpole() -> rt.Solution:
    phase = swing_up()
    return plan(phase, 10)


def panels(figure: Figure) -> dict[str, Axes]:
    return {axes.get_title("left"): axes for axes in figure.axes if axes.axison}


def dashed_levels(axes: Axes) -> list[float]:
    lines = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert all(len(set(line.get_ydata())) == 1 for line in lines)
    return sorted(float(np.asarray(line.get_ydata())[0]) for line in lines)


def curves(axes: Axes) -> list[np.ndarray]:
    return [np.asarray(line.get_xydata()) for line in axes.lines if line.get_linestyle() == "-"]


def dots(axes: Axes, filled: bool) -> np.ndarray:
    chosen = [
        np.asarray(line.get_xydata())
        for line in axes.lines
        if line.get_marker() == "o" and (line.get_markerfacecolor() != "white") is filled
    ]
    return np.concatenate(chosen)


def test_a_robot_shows_four_quantities_in_both_units(cartpole: rt.Solution) -> None:
    figure = cartpole.plot()
    assert list(panels(figure)) == [
        "position [m]",
        "position [rad]",
        "velocity [m/s]",
        "velocity [rad/s]",
        "acceleration [m/s²]",
        "acceleration [rad/s²]",
        "effort [N]",
    ]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["slider", "pole", "limit", "knot", "collocation point"]
    assert "swing-up" in figure.get_suptitle() and "58.8" not in figure.get_suptitle()
    assert f"{cartpole.objective:.6g}" in figure.get_suptitle()


def test_curves_are_the_solution(cartpole: rt.Solution) -> None:
    shown = panels(cartpole.plot())
    for title, values in (
        ("position [rad]", lambda sample: sample.q[:, 1]),
        ("velocity [m/s]", lambda sample: sample.v[:, 0]),
        ("acceleration [rad/s²]", lambda sample: sample.a[:, 1]),
        ("effort [N]", lambda sample: sample.tau[:, 0]),
    ):
        (curve,) = curves(shown[title])
        inside = ~np.isin(curve[:, 0], cartpole.knots)
        assert inside.sum() > 500
        assert np.array_equal(curve[inside, 1], values(cartpole.at(curve[inside, 0])))


def test_limits_are_drawn_in_reach_and_named_out_of_it(cartpole: rt.Solution) -> None:
    shown = panels(cartpole.plot())
    assert dashed_levels(shown["effort [N]"]) == [-20.0, 20.0]
    assert dashed_levels(shown["velocity [m/s]"]) == []
    assert shown["position [rad]"].get_title("right") == "limits out of view: ±6.283"
    assert dashed_levels(shown["position [rad]"]) == []
    low, high = shown["effort [N]"].get_ylim()
    assert low < -20 and high > 20


def test_knots_and_collocation_points_are_marked_apart(cartpole: rt.Solution) -> None:
    axes = panels(cartpole.plot())["position [m]"]
    knots, between = dots(axes, filled=True), dots(axes, filled=False)
    assert np.array_equal(knots[:, 0], cartpole.knots)
    assert np.allclose(between[:, 0], 0.5 * (cartpole.knots[1:] + cartpole.knots[:-1]), rtol=0, atol=1e-12)
    assert np.array_equal(knots[:, 1], cartpole.at(knots[:, 0]).q[:, 0])  # type: ignore[index]


def test_many_points_are_marked_below_the_curves() -> None:
    solution = plan(block(), 150)
    axes = panels(solution.plot())["state x [m]"]
    ticks = [np.asarray(line.get_xdata()) for line in axes.lines if line.get_marker() == "|"]
    assert sorted(len(tick) for tick in ticks) == [150, 151]
    assert all(line.get_marker() != "o" for line in axes.lines)


def test_a_constant_control_is_drawn_in_steps() -> None:
    solution = plan(block(states={}), 10, rt.HermiteSimpson(control=rt.schemes.ConstantControl()))
    (curve,) = curves(panels(solution.plot())["control u [N]"])
    knots = solution.knots
    assert np.allclose(curve[curve[:, 0] < knots[5] - 1e-9, 1], 1.0, rtol=0, atol=1e-6)
    at_switch = curve[curve[:, 0] == knots[5], 1]
    assert np.allclose(at_switch, [1.0, -1.0], rtol=0, atol=1e-6)


def test_a_system_has_its_own_words_and_one_sided_limits() -> None:
    shown = panels(plan(block(), 10).plot())
    assert list(shown) == ["state x [m]", "state v [m/s]", "control u [N]"]
    assert dashed_levels(shown["state v [m/s]"]) == [2.0]
    assert dashed_levels(shown["control u [N]"]) == [-1.0, 1.0]


def test_variables_of_one_unit_share_axes_and_a_legend() -> None:
    system = rt.System(["x", "y"], ["u"], lambda p: [p.x["y"], p.u["u"]])
    phase = rt.Phase(system, 1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort())
    shown = panels(plan(phase, 5).plot())
    assert list(shown) == ["state", "control u"]
    legend = shown["state"].get_legend()
    assert legend is not None and [text.get_text() for text in legend.get_texts()] == ["x", "y"]
    assert len(curves(shown["state"])) == 2


def test_phases_are_banded_and_limits_end_with_them() -> None:
    push = block(end=None, duration=2.0, controls={"u": rt.between(-1, 1)}, name="push")
    brake = block(start=None, duration=6.0, controls={"u": rt.between(-0.9, 0.9)}, name="brake")
    solution = rt.plan(rt.Problem([push, brake], [rt.Continuity(0, 1)]), rt.Mesh(5))
    axes = panels(solution.plot())["control u [N]"]
    assert {text.get_text() for text in axes.texts} == {"push", "brake"}
    spans = {
        (float(line.get_xdata()[0]), float(line.get_xdata()[1])): abs(float(line.get_ydata()[0]))  # type: ignore[index]
        for line in axes.lines
        if line.get_linestyle() == "--"
    }
    assert spans == {(0.0, 2.0): 1.0, (2.0, 8.0): 0.9}
    assert len(axes.patches) == 1


def test_the_plot_of_a_failed_solution_is_marked_in_red() -> None:
    solution = plan(block(duration=3.0), 5, check=False)
    figure = solution.plot()
    assert figure.get_suptitle().startswith("INFEASIBLE")
    assert figure._suptitle.get_color() == "firebrick"  # type: ignore[attr-defined]


def test_figures_save_without_pyplot_or_display(cartpole: rt.Solution, tmp_path: Path) -> None:
    path = cartpole.save(tmp_path / "swing.npz")
    code = (
        "import sys, robotraj as rt; assert 'matplotlib' not in sys.modules;"
        f"rt.load_solution({str(path)!r}).plot().savefig({str(tmp_path / 'swing.png')!r});"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(rt.__file__).parents[1], env={"MPLBACKEND": ""})
    assert (tmp_path / "swing.png").read_bytes().startswith(b"\x89PNG")
