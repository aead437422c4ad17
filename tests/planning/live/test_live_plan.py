"""A watched plan: a window without a browser sees every iterate, and the plan is the same."""

import base64
import json
import re
import threading
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


class Recorder:
    """A window that records its events."""

    def __init__(self) -> None:
        self.pages: list[str] = []
        self.events: list[dict[str, Any]] = []
        self.closed = 0

    def open(self, page: str) -> None:
        self.pages.append(page)

    def send(self, event: dict[str, object]) -> None:
        self.events.append(json.loads(json.dumps(event, allow_nan=False)))

    def close(self) -> None:
        self.closed += 1

    @property
    def iterates(self) -> list[dict[str, Any]]:
        return [event for event in self.events if event["kind"] == "iterate"]


@pytest.fixture(scope="module")
def arm() -> rt.Robot:
    return rt.load("two_link_arm")


def reach(arm: rt.Robot, **options: Any) -> rt.Phase:
    given = {"duration": 4.0, "objective": rt.Effort(), "name": "reach"} | options
    return rt.Phase(arm, start=rt.State(q=0, v=0), end=rt.State(q=[1.0, 0.5], v=0), **given)


def poses_of(event: dict[str, Any]) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(event["poses"]), np.float32)
    return values.reshape(event["samples"], -1, 7)


@pytest.mark.parametrize("solver", [rt.InteriorPoint(), rt.Ipopt()])
def test_the_iterates_end_at_the_solution_that_is_found_without_watching(arm: rt.Robot, solver: Any) -> None:
    window = Recorder()
    mesh = rt.Mesh(8)
    solution = rt.plan(reach(arm, limits=None), mesh=mesh, solver=solver, watch=window)
    alone = rt.plan(reach(arm, limits=None), mesh=mesh, solver=solver)
    assert solution.objective == alone.objective
    assert window.closed == len(window.pages) == 1
    *steps, last = window.iterates
    assert [event["number"] for event in steps] == list(range(len(steps)))
    # Some solvers report the last iterate as well.
    assert solution.iterations <= len(steps) <= solution.iterations + 1
    assert steps[-1]["infeasibility"] < 1e-6
    assert {(event["solve"], event["intervals"], event["duration"]) for event in steps} == {(1, 8, 4.0)}
    for event, near in ((steps[-1], 1e-4), (last, 1e-5)):
        times = np.linspace(0.0, 4.0, event["samples"])
        drawn = poses_of(event)
        data = arm.model.createData()
        for t, row in zip(times, drawn, strict=True):
            pin.forwardKinematics(arm.model, data, solution.at(t).q)
            for joint, pose in enumerate(row, 1):
                np.testing.assert_allclose(pose[:3], data.oMi[joint].translation, atol=near)
                turn = pin.Quaternion(*(float(x) for x in (pose[6], *pose[3:6]))).matrix()
                np.testing.assert_allclose(turn, data.oMi[joint].rotation, atol=near)
    assert window.events[-1] == {
        "kind": "end",
        "text": "solved; nothing was proved",
        "colour": "unproved",
        "message": solution.message,
    }


def test_every_mesh_of_a_proved_plan_is_a_solve(arm: rt.Robot) -> None:
    window = Recorder()
    solution = rt.plan(reach(arm, duration=(1.0, 10.0), objective=rt.Duration()), watch=window)
    assert window.events[-1]["text"] == "proved, not validated"
    starts = [event for event in window.iterates if event["number"] == 0]
    assert [event["solve"] for event in starts] == list(range(1, len(starts) + 1))
    assert starts[-1]["intervals"] == solution.refinement[-1].intervals
    assert window.iterates[-1]["duration"] == pytest.approx(solution.duration)


def test_the_page_may_read_from_its_own_server_and_from_nowhere_else(arm: rt.Robot) -> None:
    window = Recorder()
    rt.plan(reach(arm), mesh=rt.Mesh(4), watch=window)
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', window.pages[0])
    assert "default-src 'none'" in policy and "connect-src 'self' data: blob:" in policy
    assert "two_link_arm" in window.pages[0]


def test_a_system_has_curves_and_no_poses() -> None:
    block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda p: [p.x["v"], p.u["u"]], name="block")
    move = rt.Phase(block, duration=1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort())
    window = Recorder()
    solution = rt.plan(move, mesh=rt.Mesh(4), watch=window)
    assert window.iterates[0]["number"] == 0
    assert not any("poses" in event for event in window.events)
    assert window.events[-1]["kind"] == "end"
    states, controls = window.iterates[-1]["charts"]
    assert [curve["label"] for curve in states["curves"]] == ["x", "v"]
    (force,) = controls["curves"]
    sample = solution.at(np.array(force["t"]))
    np.testing.assert_allclose(force["y"], sample.u["u"], atol=1e-4)
    for curve in states["curves"]:
        np.testing.assert_allclose(curve["y"], sample.x[curve["label"]], atol=1e-4)
    # The first guess is a straight line at rest.
    assert window.iterates[0]["charts"][0]["curves"][0]["y"] != states["curves"][0]["y"]


def test_a_plan_that_fails_says_so_and_closes_its_window(arm: rt.Robot) -> None:
    window = Recorder()
    with pytest.raises(rt.NoSolutionFound):
        rt.plan(reach(arm), mesh=rt.Mesh(8), solver=rt.Ipopt(max_iterations=1), watch=window)
    assert window.closed == 1
    assert window.events[-1]["colour"] == "bad"


def test_a_window_that_raises_ends_the_plan_and_is_closed(arm: rt.Robot) -> None:
    class Broken(Recorder):
        def send(self, event: dict[str, object]) -> None:
            raise RuntimeError("no paper")

    window = Broken()
    with pytest.raises(RuntimeError, match="no paper"):
        rt.plan(reach(arm), mesh=rt.Mesh(4), watch=window)
    assert window.closed == 1


@pytest.mark.parametrize("watch", [None, "yes", 1, Recorder])
def test_what_is_no_window_is_refused(arm: rt.Robot, watch: Any) -> None:
    with pytest.raises(rt.InputError, match="True, False or a window"):
        rt.plan(reach(arm), mesh=rt.Mesh(4), watch=watch)


def test_without_a_screen_the_address_is_printed_and_no_thread_is_left(
    arm: rt.Robot, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    before = threading.active_count()
    assert rt.plan(reach(arm), mesh=rt.Mesh(4), watch=True).success
    assert "http://127.0.0.1:" in capsys.readouterr().err
    assert threading.active_count() == before
