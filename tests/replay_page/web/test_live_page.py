"""The page of a plan that is being made, in a headless Chromium that reads from the plan's own thread."""

import threading
import webbrowser
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
    page.wait_for_function("() => document.getElementById('status').textContent === 'proved'", timeout=60_000)
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
