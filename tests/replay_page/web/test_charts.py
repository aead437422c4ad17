"""The charts in a headless Chromium: scales, groups, values under the pointer, zoom, isolation."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from robotraj.replay_page.write import replay

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABELS = "() => robotraj.charts.filter((chart) => !chart.empty).map((chart) => [chart.labels.y, chart.labels.x])"
WEIGHTS = "(labels) => labels.map((label) => robotraj.selection.weight(label))"
WINDOW = "() => robotraj.selection.window"


def number(text: str) -> float:
    return float(text.replace("−", "-"))


def test_every_axis_has_three_labels_at_even_steps(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "page.html", periods=2)
    page = browser.open(path)
    # The root's positions and velocities have other sizes than those of the joints.
    for size in browser.sizes(page):
        for group in range(-1, 3):
            page.evaluate("(group) => robotraj.selection.set({ group })", group)
            for labels in (labels for axes in page.evaluate(LABELS) for labels in axes):
                values = [number(text) for text in labels]
                assert len(values) >= 3, size
                np.testing.assert_allclose(np.diff(values), np.diff(values)[0], rtol=1e-6)
    browser.check(path)


def test_scales_are_right_for_any_size_of_the_values(block_plan: Any, browser: Any, tmp_path: Any) -> None:
    page = browser.open(replay(block_plan, tmp_path / "block.html"))
    for low, high in ((-1e-7, 3e-7), (0.999, 1.001), (-2.3, 4.1), (12_000, 950_000), (-8.7e8, 1e3), (0.0, 1.0)):
        found = page.evaluate("([low, high]) => ticks(low, high, 2)", [low, high])
        assert len(found) >= 3
        for value, text in found:
            assert low - 1e-9 * (high - low) <= value <= high + 1e-9 * (high - low)
            assert number(text) == pytest.approx(value, abs=0.02 * (high - low))
        assert len({text for _, text in found}) == len(found)


def test_one_leg_is_drawn_strongly_and_a_key_or_click_chooses_another(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "walk.html", periods=2)
    page = browser.open(path)
    labels = ["left_knee", "right_knee", "root_x"]
    # Few joints are all strong at first, the root's are left out.
    assert page.evaluate(WEIGHTS, labels) == [3, 3, 0]
    page.keyboard.press("g")
    assert page.evaluate(WEIGHTS, labels) == [3, 1, 0]
    page.keyboard.press("o")
    assert page.evaluate(WEIGHTS, labels) == [3, 0, 0]
    page.locator("#groups button", has_text="root").click()
    assert page.evaluate(WEIGHTS, labels) == [0, 0, 3]
    # The torques of a root are none, so their chart is not shown.
    assert page.locator(".chart:visible h2 div").all_inner_texts() == [
        "Joint position [m, rad]",
        "Joint velocity [m/s, rad/s]",
    ]
    browser.check(path)


def test_pointing_at_a_curve_gives_its_value_there(ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any) -> None:
    plan = wave_plan(ur5, 2.0)
    page = browser.open(replay(plan, tmp_path / "page.html"))
    joint, t = 2, 1.3
    name, value = ur5.joint_names[joint], plan.phases[0].at(t).q[0][joint]
    place = page.evaluate("([t, y]) => [robotraj.charts[0].x(t), robotraj.charts[0].y(y)]", [t, value])
    box = page.locator(".plot").first.bounding_box()
    page.mouse.move(box["x"] + place[0], box["y"] + place[1])
    said = page.locator(".tip").first.inner_text()
    match = re.fullmatch(r"(\S+): (\S+) rad at (\S+) s", said)
    assert match is not None and match[1] == name
    assert number(match[3]) == pytest.approx(t, abs=0.01)
    assert number(match[2]) == pytest.approx(value, abs=0.02)
    page.mouse.dblclick(box["x"] + place[0], box["y"] + place[1])
    others = [other for other in ur5.joint_names if other != name]
    assert page.evaluate(WEIGHTS, [name, *others]) == [3, 0, 0, 0, 0, 0]
    assert page.locator("#legend tbody tr:visible").count() == 1
    page.keyboard.press("Escape")
    assert page.evaluate(WEIGHTS, others) == [3] * 5


def test_time_is_zoomed_about_the_pointer_and_moved(double_pendulum: Any, browser: Any, wave_plan: Any, tmp_path: Any):
    page = browser.open(replay(wave_plan(double_pendulum, 4.0, start=1.0, phases=2), tmp_path / "page.html"))
    box = page.locator(".plot").first.bounding_box()
    x, y = box["x"] + 62.0 + 0.25 * (box["width"] - 74.0), box["y"] + 40.0
    page.mouse.move(x, y)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -400)
    page.keyboard.up("Control")
    page.wait_for_function("() => robotraj.selection.span < 3.9")
    start, end = page.evaluate(WINDOW)
    assert (2.0 - start) / (end - start) == pytest.approx(0.25, abs=0.01)
    page.keyboard.down("Shift")
    page.mouse.down()
    page.mouse.move(x - 60.0, y, steps=3)
    page.mouse.up()
    page.keyboard.up("Shift")
    moved = page.evaluate(WINDOW)
    assert moved[1] - moved[0] == pytest.approx(end - start)
    assert moved[0] > start
    # The bars above show the same window: a phase outside of it has no bar.
    page.evaluate("() => robotraj.selection.show(1.0, 2.0)")
    assert page.locator("#bars .phase:visible").count() == 1
    page.keyboard.press("0")
    assert page.evaluate(WINDOW) == [1.0, 5.0]
    assert page.locator("#bars .phase:visible").count() == 2


def test_names_of_phases_that_do_not_fit_are_numbers_with_a_list(ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any):
    plan = wave_plan(ur5, 4.0, phases=2)
    plan.phases[1].phase.name = "a phase whose name is much longer than the bar that stands for it on any screen"
    page = browser.open(replay(plan, tmp_path / "page.html"))
    assert page.locator("#bars .phase").all_inner_texts() == ["1", "2"]
    assert page.locator(".phase-names li").all_inner_texts() == ["1wave 1", f"2{plan.phases[1].phase.name}"]


def test_curves_of_a_group_differ_in_colour_and_dash(browser: Any, talos: Any, wave_plan: Any, tmp_path: Any) -> None:
    page = browser.open(replay(wave_plan(talos, 1.0), tmp_path / "page.html"))
    groups = page.evaluate(
        "() => robotraj.selection.groups.map((g, k) => { robotraj.selection.set({ group: k });"
        " return g.labels.map((l) => robotraj.selection.look(l, 0)); })"
    )
    for looks in groups:
        pairs = [(look["color"], tuple(look["dash"])) for look in looks[:7]]
        assert len({color for color, _ in pairs}) == len(pairs)
        assert len({dash for _, dash in pairs}) == len(pairs)


def test_jumps_of_a_state_are_marked_and_those_of_a_control_are_not(block_plan: Any, browser: Any, tmp_path: Any):
    """The control of the block jumps by its plan; its position would not obey the equations if it did."""
    drawn = "() => robotraj.charts.every((chart) => chart.high > chart.low)"
    jumps = "() => robotraj.charts.map((chart) => jumpsOf(chart))"
    page = browser.open(replay(block_plan, tmp_path / "block.html"))
    page.wait_for_function(drawn)
    assert page.evaluate(jumps) == [[], []]
    part = block_plan.phases[0]

    def broken(t: np.ndarray, interval: int | None = None) -> Any:
        sample = part.read(t, interval)
        sample.x["x"] = sample.x["x"] + 0.25 * (t > 1.0 if interval is None else interval >= 1)
        return sample

    plan = replace(block_plan, phases=(replace(part, read=broken),))
    page = browser.open(replay(plan, tmp_path / "broken.html"))
    page.wait_for_function(drawn)
    states, controls = page.evaluate(jumps)
    assert states == [[1.0, 0.5, 0.75]] and controls == []
