"""The replay of real solutions, planned here."""

import base64
import gzip
import json
import re

import numpy as np
import pytest

import robotraj as rt
from robotraj.replay_page.write import replay
from tests.robots import cartpole


def data_of(path) -> dict:
    (packed,) = re.findall(r'id="data">([^<]*)<', path.read_text())
    return json.loads(gzip.decompress(base64.b64decode(packed)))["runs"][0]


@pytest.fixture(scope="module")
def swing_up():
    phase = cartpole.swing_up(
        constraints=[rt.GroundClearance("tip", 0.0, ground=rt.terrain.Flat(-1.0))], name="swing up"
    )
    return rt.plan(phase, mesh=rt.Mesh(10, rt.HermiteSimpson()))


def test_a_planned_swing_up_shows_its_motion_limits_and_ground(swing_up, tmp_path):
    path = replay(swing_up, tmp_path / "cartpole.html")
    text, data = path.read_text(), data_of(path)
    assert '<dd id="status" class="status unproved">solved; nothing was proved</dd>' in text
    assert "<h1>cartpole</h1>" in text
    knots = [round(0.2 * k, 6) for k in range(11)]
    assert data["phases"] == [{"name": "swing up", "start": 0.0, "end": 2.0, "knots": knots}]
    assert data["scene"]["ground"] == {"level": -1.0, "surface": False}
    position, _, force = data["charts"]
    assert (position["pieces"][0]["lower"][0], position["pieces"][0]["upper"][0]) == (-2.0, 2.0)
    assert (force["pieces"][0]["lower"], force["pieces"][0]["upper"]) == ([-20.0], [20.0])
    assert [s["label"] for s in force["series"]] == ["slider"]
    end = [column[-1] for column in position["pieces"][0]["y"]]
    np.testing.assert_allclose(end, [1.0, np.pi], atol=1e-5)


def test_the_report_of_a_plan_on_a_given_mesh_is_its_verdict_and_stands_on_the_page(tmp_path):
    phase = rt.Phase(rt.load("two_link_arm"), 4.0, rt.State(q=0, v=0), rt.State(q=[0.3, 0.1], v=0), rt.Effort())
    solution = rt.plan(phase, mesh=rt.Mesh(20))
    report = rt.validate(solution)
    assert report.passed
    path = replay(solution, tmp_path / "arm.html", report=report)
    assert (
        '<dd id="status" class="status unproved">validated by simulation; not judged: optimum</dd>' in path.read_text()
    )
    assert data_of(path)["proof"]["report"].startswith("Validation of") and "PASSED" in data_of(path)["proof"]["report"]
    both = replay([solution, solution], tmp_path / "both.html", labels=["one", "other"], report=[None, report])
    assert '<dd id="status" class="status unproved">one: solved; nothing was proved</dd>' in both.read_text()
    strict = rt.validate(solution, local=1e-15)
    assert (
        '<dd id="status" class="status bad">validation failed</dd>' in replay(solution, path, report=strict).read_text()
    )


def test_a_report_belongs_to_its_solution(swing_up, tmp_path):
    phase = rt.Phase(rt.load("two_link_arm"), 4.0, rt.State(q=0, v=0), rt.State(q=[1, 0.5], v=0), rt.Effort())
    report = rt.validate(rt.plan(phase, mesh=rt.Mesh(20)))
    with pytest.raises(rt.InputError, match="a plan of 4 s, but the solution takes 2 s"):
        replay(swing_up, tmp_path / "arm.html", report=report)
    with pytest.raises(rt.InputError, match="one report for each of the 1 solutions; got 2"):
        replay(swing_up, tmp_path / "arm.html", report=[report, report])
    with pytest.raises(rt.InputError, match="what rt.validate returned; got True"):
        replay(swing_up, tmp_path / "arm.html", report=True)


def test_a_failed_plan_is_shown_as_one(tmp_path):
    phase = cartpole.swing_up()
    solution = rt.plan(phase, mesh=rt.Mesh(10, rt.HermiteSimpson()), solver=rt.Ipopt(max_iterations=1), check=False)
    assert not solution.success
    text = replay(solution, tmp_path / "cartpole.html").read_text()
    assert f'<dd id="status" class="status bad">{solution.status.value}</dd>' in text


def test_a_planned_system_has_curves_with_its_bounds(tmp_path):
    block = rt.System(
        states=["x", "v"],
        controls=["u"],
        dynamics=lambda point: [point.x["v"], point.u["u"]],
        units={"x": "m", "v": "m/s", "u": "N"},
        name="block",
    )
    phase = rt.Phase(
        block,
        duration=(0.1, 20.0),
        start=rt.State({"x": 0, "v": 0}),
        end=rt.State({"x": 10, "v": 0}),
        states={"v": rt.between(-3, 3)},
        controls={"u": rt.between(-1, 1)},
        objective=rt.Duration(),
        name="move",
    )
    solution = rt.plan(phase, mesh=rt.Mesh(10, rt.HermiteSimpson()))
    states, controls = data_of(replay(solution, tmp_path / "block.html"))["charts"]
    assert states["series"] == [
        {"label": "x", "unit": "m", "variable": "x"},
        {"label": "v", "unit": "m/s", "variable": "v"},
    ]
    assert (states["pieces"][0]["lower"], states["pieces"][0]["upper"]) == ([None, -3.0], [None, 3.0])
    assert (controls["pieces"][0]["lower"], controls["pieces"][0]["upper"]) == ([-1.0], [1.0])
