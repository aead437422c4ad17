"""The page of a plan that is being made, in a headless Chromium that reads from the plan's own thread."""

import re
import threading
import webbrowser
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.replay_page.live.live_window import BrowserWindow

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_the_robot_moves_towards_the_solution_and_the_verdict_comes_last(
    chromium: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, 4.0, rt.State(q=0, v=0), rt.State(q=[1.0, 0.5], v=0), rt.Effort(), name="reach")
    called = threading.Event()
    monkeypatch.setattr(webbrowser, "open", lambda address: called.set())
    window = BrowserWindow(show=True, wait=60.0)
    found: list[rt.Solution] = []
    planning = threading.Thread(target=lambda: found.append(rt.plan(phase, watch=window)))
    planning.start()
    assert called.wait(60.0)
    page = chromium.new_context(viewport={"width": 1200, "height": 800}).new_page()
    console: list[str] = []
    requests: list[str] = []
    page.on("console", lambda m: console.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: console.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(window.address)
    status = "document.getElementById('status').textContent"
    page.wait_for_function(f"() => {status} === 'proved, not validated'", timeout=60_000)
    planning.join(60.0)
    assert not planning.is_alive()
    # Every iterate that was sent is shown, the solution last.
    shown, last = page.evaluate("() => [robotraj.live.shown, robotraj.live.iterates.length - 1]")
    assert shown == last >= 5
    data = arm.model.createData()
    pin.forwardKinematics(arm.model, data, found[0].at(4.0).q)
    end = page.evaluate("() => { const [p] = robotraj.view.pose(2, robotraj.view.samples - 1); return p.toArray(); }")
    np.testing.assert_allclose(end, data.oMi[2].translation, atol=1e-5)
    first = page.evaluate("() => { robotraj.live.go(0, false); return Array.from(robotraj.view.values); }")
    assert np.ptp(first) > 0.0 and page.locator("#latest").get_attribute("aria-pressed") == "false"
    assert console == []
    own = {url for url in requests if not url.startswith(("data:", "blob:"))}
    assert own == {window.address, window.address + "events"}


def test_a_system_shows_the_curves_of_every_iterate(browser: Any, tmp_path: Any) -> None:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], units={"x": "m"}, name="block")
    move = rt.Phase(system, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), name="move")
    pages: list[str] = []
    events: list[dict[str, Any]] = []
    window = SimpleNamespace(open=pages.append, send=events.append, close=lambda: None)
    rt.plan(move, mesh=rt.Mesh(4), watch=window)
    path = tmp_path / "live.html"
    path.write_text(pages[0].replace("EventSource(EVENTS)", "Object()"))  # there is no server here
    # The page's own policy refuses a script that was changed, so that it is left out.
    path.write_text(re.sub(r"<meta http-equiv=[^>]*>", "", path.read_text()))
    page = browser.open(path, 1024, 768)
    page.evaluate("events => events.forEach((event) => robotraj.live.take(event))", events)
    page.wait_for_function("() => document.getElementById('status').textContent.startsWith('solved')")
    assert page.locator("#iterate canvas").count() == 2
    assert page.locator("#iterate .labels").first.inner_text().split() == ["x", "[m]", "v"]
    assert page.locator("#latest").is_visible() and not page.locator("#pane").is_visible()
    page.evaluate("() => robotraj.live.go(0, false)")
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 1024
    browser.check(path)
