"""The page on screens of any size, by keyboard, in dark and light, and for screen readers."""

from typing import Any

import pytest

import robotraj as rt
from robotraj.replay_page.write import replay

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PHONE, LYING = (390, 844), (844, 390)
SMALL = """() => [...document.querySelectorAll("button, select, input, summary, [role=tab]")]
  .filter((e) => e.offsetParent !== null && !e.disabled)
  .map((e) => [e.textContent || e.id, e.getBoundingClientRect()])
  .filter(([, box]) => Math.min(box.width, box.height) < 24)
  .map(([name]) => name)"""
CLIPPED = """() => [...document.querySelectorAll("button, h1, h2, td, th, dd, li, select")]
  .filter((e) => e.offsetParent !== null && e.getBoundingClientRect().right > innerWidth + 1)
  .filter((e) => { for (let n = e.parentElement; n; n = n.parentElement) {
    if (n.scrollWidth > n.clientWidth && ["auto", "scroll"].includes(getComputedStyle(n).overflowX)) return false; }
    return true; })
  .map((e) => e.textContent)"""


def test_nothing_is_clipped_and_every_target_has_24_pixels(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "walk.html", periods=4)
    page = browser.open(path, moment="#t=0.3")
    for size in browser.sizes(page):
        for panel in ("curves", "proof", "meshes", "problem", "settings"):
            page.locator(f"#tab-{panel}").click()
            assert page.evaluate("() => document.documentElement.scrollWidth") <= size[0], (size, panel)
            assert page.evaluate(SMALL) == [], (size, panel)
            assert panel != "curves" or page.evaluate(CLIPPED) == [], size
    browser.check(path)


def test_a_phone_scrolls_past_the_robot_and_lying_down_shows_a_whole_chart(walk: Any, browser: Any, tmp_path: Any):
    path = replay(walk, tmp_path / "walk.html", periods=4)
    upright, lying = browser.open(path, *PHONE, has_touch=True), browser.open(path, *LYING, has_touch=True)
    assert upright.locator("#pane canvas").evaluate("(e) => getComputedStyle(e).touchAction") == "pan-y"
    upright.mouse.move(195, 300)
    upright.evaluate("() => document.getElementById('legend').scrollIntoView()")
    assert upright.evaluate("() => scrollY") > 500
    assert upright.locator("#play").bounding_box()["y"] < 844
    chart, footer = (lying.locator(which).first.bounding_box() for which in (".chart", "footer"))
    assert chart["y"] + chart["height"] <= footer["y"]
    assert lying.locator("#pane canvas").bounding_box()["width"] > 350


def test_nothing_lies_over_the_robot(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "walk.html")
    page = browser.open(path)
    for size in browser.sizes(page):
        over = page.evaluate(
            """() => { const box = document.getElementById("pane").getBoundingClientRect(), found = new Set();
              for (let i = 1; i < 12; i++) for (let j = 1; j < 12; j++) {
                const top = document.elementFromPoint(box.x + (i / 12) * box.width, box.y + (j / 12) * box.height);
                if (top && !document.getElementById("pane").contains(top)) found.add(top.id || top.className);
              } return [...found]; }"""
        )
        assert set(over) <= {"scrubber", "play", ""}, size


def test_keys_work_whatever_was_clicked(walk: Any, browser: Any, tmp_path: Any) -> None:
    page = browser.open(replay(walk, tmp_path / "walk.html", periods=4))
    playing = "() => robotraj.player.playing"
    for click in (".chart button", "#groups button", "#home", "#loop", "#tab-curves", "#pane", "[data-layer=frames]"):
        page.locator(click).first.click()
        before = page.evaluate(playing)
        page.keyboard.press(" ")
        assert page.evaluate(playing) != before, click
    page.evaluate("() => robotraj.seek(1.4)")
    page.locator("#speed").focus()
    page.keyboard.press("k")
    assert page.evaluate(playing)
    page.keyboard.press("k")
    page.locator("#scrubber").focus()
    page.keyboard.press("Home")
    assert page.evaluate("() => robotraj.time()") == 0.0
    page.keyboard.press("ArrowRight")
    assert page.evaluate("() => robotraj.time()") == pytest.approx(0.028)
    page.keyboard.press("Shift+ArrowRight")
    assert page.evaluate("() => robotraj.time()") == pytest.approx(0.308)
    page.keyboard.press("End")
    assert page.evaluate("() => robotraj.time()") == pytest.approx(2.8)
    # With the keyboard alone, Space presses the button that has the focus.
    page.locator("[data-layer=robot]").focus()
    page.keyboard.press(" ")
    assert page.locator("[data-layer=robot]").get_attribute("aria-pressed") == "false"
    page.keyboard.press("?")
    assert page.locator("#keys").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("#keys").is_visible()


def test_slider_curves_and_values_have_words(walk: Any, browser: Any, tmp_path: Any) -> None:
    page = browser.open(replay(walk, tmp_path / "walk.html", periods=2))
    page.evaluate("() => robotraj.seek(1.0)")
    assert page.locator("#scrubber").get_attribute("aria-valuetext") == "1.00 of 1.40 s, step (mirrored)"
    told = page.locator(".chart canvas").first.get_attribute("aria-label")
    assert told.startswith("Joint position from 0.000 to 1.400 s. left_hip from ")
    page.wait_for_function("() => document.getElementById('said').textContent.includes('left_hip q ')")
    assert page.locator("#said").get_attribute("aria-live") == "polite"
    assert page.locator("#legend th[scope=row]").count() == page.locator("#legend tbody tr").count()


def test_dark_and_light_follow_the_system_until_chosen(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "walk.html")
    paper = "() => getComputedStyle(document.getElementById('side')).backgroundColor"
    light, dark = browser.open(path, color_scheme="light"), browser.open(path, color_scheme="dark")
    assert light.evaluate(paper) == "rgb(255, 255, 255)"
    assert dark.evaluate(paper) == "rgb(21, 27, 34)"
    dark.locator("#theme").click()
    assert dark.evaluate(paper) == light.evaluate(paper)
    dark.keyboard.press("d")
    assert dark.evaluate(paper) == "rgb(21, 27, 34)"
    light.emulate_media(color_scheme="dark")
    light.wait_for_function("() => document.documentElement.dataset.theme === 'dark'")
    browser.check(path)


def test_settings_wrap_in_a_table_with_their_reasons(browser: Any, tmp_path: Any) -> None:
    phase = rt.Phase(rt.load("pendulum"), 2.0, rt.State(q=0, v=0), rt.State(q=3.0, v=0), rt.Effort())
    solution = rt.plan(phase, mesh=rt.Mesh(8))
    page = browser.open(replay(solution, tmp_path / "swing.html"), *PHONE)
    page.locator("#tab-settings").click()
    rows = page.locator("#panel-settings tr").evaluate_all("rows => rows.map((row) => row.innerText.split('\\t'))")
    found = {name: " ".join(choice.split()) for name, choice in rows}
    assert list(found)[:3] == ["tolerance", "goals", "mesh"] and len(found) >= 8
    assert " ".join(str(solution.settings).split()) == " ".join(f"{name} {choice}" for name, choice in found.items())
    overflow = "(e) => e.scrollWidth - e.clientWidth"
    assert page.locator("#panel-settings").evaluate(overflow) <= 1
