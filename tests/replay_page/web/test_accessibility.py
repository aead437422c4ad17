"""axe-core on pages of every kind, wide and narrow, in light and dark; the package bundles its script.

Pictures stay in pytest's temporary folder, to be looked at: ``pytest --basetemp=FOLDER``.
"""

from __future__ import annotations

import threading
import webbrowser
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.replay_page.live.live_window import BrowserWindow

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = {(1400, 900): "light", (390, 844): "dark"}
MORE_SIZES = {(1024, 768): "dark", (844, 390): "light"}
FAILING = """async (parts) => (await axe.run(parts || document, { resultTypes: ["violations"] })).violations
  .filter((violation) => ["serious", "critical"].includes(violation.impact))
  .map((violation) => [violation.id, violation.nodes.map((node) => node.html.slice(0, 120))])"""


def failing(page: Any, *parts: str) -> list[Any]:
    """Return the serious and critical violations that axe-core finds in parts of a page, by default in all of it."""
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(pytest.importorskip("axe_playwright_python.base").AXE_SCRIPT)
    return page.evaluate(FAILING, {"include": [[part] for part in parts]} if parts else None)


def pendulum(path: Path) -> None:
    """A swing-up, proved and simulated."""
    robot = rt.load("double_pendulum", limits={"effort": 5.0, "velocity": 20.0, "position": 6.3})
    start, end = rt.State(q=0, v=0), rt.State(q=[np.pi, 0], v=0)
    solution = rt.plan(rt.Phase(robot, (0.5, 5.0), start, end, rt.Effort() + rt.Duration(), name="swing up"))
    rt.replay(solution, path, report=rt.validate(solution))


def _reach(end: list[float], *constraints: Any, duration: Any = (0.2, 5.0), objective: Any = None) -> rt.Phase:
    start = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0)
    objective = objective or rt.Duration()
    return rt.Phase(rt.load("ur5"), duration, start, rt.State(q=end, v=0), objective, constraints=constraints)


def arm(path: Path) -> None:
    """An arm on a mesh, of which nothing is proved."""
    rt.replay(rt.plan(_reach([1.1, -0.8, 0.6, -0.6, -0.6, 1.2]), mesh=rt.Mesh(12)), path)


def obstacles(path: Path) -> None:
    """An arm among obstacles, with the path of its tool."""
    post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
    free = rt.CollisionFree([post], margin=0.01, self_collision=False)
    solution = rt.plan(_reach([1.1, -0.8, 0.6, -0.6, -0.6, 1.2], free), mesh=rt.Mesh(12))
    rt.replay(solution, path, traces=["tool0"])


def comparison(path: Path) -> None:
    """Three solutions on one page."""
    ends = [1.1, -0.8, 0.6, -0.6, -0.6, 1.2], [0.9, -1.0, 0.6, -0.6, -0.6, 1.2]
    solutions = [rt.plan(_reach(end), mesh=rt.Mesh(12)) for end in ends]
    solutions.append(rt.plan(_reach(ends[0], duration=2.0, objective=rt.Effort())))
    reports = [None, None, rt.validate(solutions[2])]
    rt.replay(solutions, path, labels=["far", "near", "slow"], report=reports)


def quadruped(path: Path) -> None:
    """A trot over four strides."""
    robot = rt.load("solo12", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
    foot = partial(rt.PointContact, friction=0.5)
    trot = rt.gait.trot(robot, step_length=0.06, duration=0.2, clearance=0.04, contact=foot)
    solution = rt.plan(trot, mesh=rt.Mesh(5, rt.schemes.LobattoIIIA(4)))
    rt.replay(solution, path, periods=4, report=rt.validate(solution))


def failed(path: Path) -> None:
    """A plan without a solution, with the limits that contradict each other."""
    robot = rt.load("pendulum", limits={"effort": 1.0})
    phase = rt.Phase(robot, 0.4, rt.State(q=0, v=0), rt.State(q=np.pi, v=0), rt.Effort(), name="too fast")
    solution = rt.plan(phase, check=False)
    assert not solution.success
    rt.replay(solution, path)


def equations(path: Path) -> None:
    """A system of equations, which has curves and no robot."""
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], units={"x": "m"}, name="block")
    phase = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), name="move")
    rt.replay(rt.plan(phase), path)


def check(browser: Any, path: Path, every: bool = False) -> None:
    """Open a page at two sizes; axe-core reads it at both, and each of its panels at the first.

    One page is read at four sizes with all panels and the list of keys.
    """
    for number, (size, scheme) in enumerate((SIZES | MORE_SIZES if every else SIZES).items()):
        page = browser.open(path, *size, moment="#t=0.3", color_scheme=scheme, bypass_csp=True)
        page.screenshot(path=path.with_name(f"{path.stem}_{size[0]}x{size[1]}.png"))
        assert failing(page) == [], size
        for tab in page.locator("[role=tab]").all() if every or not number else []:
            tab.click()
            panel = tab.get_attribute("aria-controls")
            assert failing(page, "[role=tablist]", f"#{panel}") == [], (size, panel)
        if every:
            page.keyboard.press("?")
            assert failing(page) == [], (size, "keys")
    browser.check(path)


@pytest.mark.parametrize("make", [pendulum, arm, obstacles, comparison, quadruped, failed, equations])
def test_axe_finds_no_serious_violation(make: Callable[[Path], None], browser: Any, tmp_path: Path) -> None:
    make(tmp_path / f"{make.__name__}.html")
    check(browser, tmp_path / f"{make.__name__}.html", make is obstacles)


def test_axe_finds_no_serious_violation_on_a_biped(walk: Any, browser: Any, tmp_path: Path) -> None:
    check(browser, rt.replay(walk, tmp_path / "biped.html", periods=4))


def test_axe_finds_no_serious_violation_on_a_live_page(
    chromium: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, 4.0, rt.State(q=0, v=0), rt.State(q=[1.0, 0.5], v=0), rt.Effort(), name="reach")
    called = threading.Event()
    monkeypatch.setattr(webbrowser, "open", lambda address: called.set())
    window = BrowserWindow(show=True, wait=60.0)
    planning = threading.Thread(target=lambda: rt.plan(phase, watch=window))
    planning.start()
    assert called.wait(60.0)
    page = chromium.new_context(viewport={"width": 1400, "height": 900}, bypass_csp=True).new_page()
    page.goto(window.address)
    status = "document.getElementById('status').textContent"
    page.wait_for_function(f"() => {status} === 'proved, not validated'", timeout=60_000)
    planning.join(60.0)
    for width, height in SIZES | MORE_SIZES:
        page.set_viewport_size({"width": width, "height": height})
        page.screenshot(path=tmp_path / f"live_{width}x{height}.png")
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert failing(page) == [], (width, height, scheme)
