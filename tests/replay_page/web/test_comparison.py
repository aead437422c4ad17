"""Several solutions on one page, the layers of the view, and the joint that is picked in it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.replay_page.write import replay

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PLACE = """([run, joint]) => {
  const node = robotraj.view.joints[run][joint], at = new MeshCat.THREE.Vector3();
  node.updateWorldMatrix(true, false);
  const box = document.getElementById("pane").getBoundingClientRect();
  const mesh = node.children.find((child) => /^visual/.test(child.name));
  new MeshCat.THREE.Box3().setFromObject(mesh).getCenter(at).project(robotraj.viewer.camera);
  return [box.x + (box.width * (at.x + 1)) / 2, box.y + (box.height * (1 - at.y)) / 2];
}"""


def test_every_solution_moves_by_its_own_plan_and_rests_at_its_end(
    ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any
):
    plans = [wave_plan(ur5, 2.0), wave_plan(ur5, 3.0, seed=1)]
    path = replay(plans, tmp_path / "two.html", labels=["short", "long"])
    page = browser.open(path)
    data = ur5.model.createData()
    for t in (0.7, 2.5):
        page.evaluate(f"() => robotraj.seek({t})")
        for number, plan in enumerate(plans, 1):
            pin.forwardKinematics(ur5.model, data, plan.phases[0].at(min(t, plan.duration)).q[0])
            poses = page.evaluate(f"() => robotraj.poses({number})")
            for joint, pose in enumerate(poses.values(), 1):
                np.testing.assert_allclose(pose["position"], data.oMi[joint].translation, atol=1e-4)
    browser.check(path)


def test_solutions_stand_side_by_side_and_the_focus_chooses_values_and_panels(
    ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any
) -> None:
    plans = [wave_plan(ur5, 2.0), wave_plan(ur5, 2.0, seed=1)]
    reports = [SimpleNamespace(passed=True, duration=2.0, claims=()), None]
    path = replay(plans, tmp_path / "two.html", labels=["one", "other"], report=reports)
    page = browser.open(path, moment="#t=1")
    verdict = page.locator("header .status")
    assert verdict.inner_text() == "one: validated by simulation"
    assert "unproved" in str(verdict.get_attribute("class"))
    here = page.evaluate("() => robotraj.poses(2).elbow_joint.position")
    page.locator("#layers button", has_text="side by side").click()
    there = page.evaluate("() => robotraj.poses(2).elbow_joint.position")
    assert np.abs(np.subtract(there, here)).max() > 0.5
    assert page.evaluate("() => robotraj.view.ghosts.every((ghost) => !ghost.material.transparent)")
    shown = "() => document.querySelector('#legend tbody td span').textContent.replace('−', '-')"
    assert float(page.evaluate(shown)) == pytest.approx(plans[0].phases[0].at(1.0).q[0][0], abs=1e-3)
    page.keyboard.press("2")
    assert float(page.evaluate(shown)) == pytest.approx(plans[1].phases[0].at(1.0).q[0][0], abs=1e-3)
    assert verdict.inner_text() == "other: solved; nothing was proved"
    assert "unproved" in str(verdict.get_attribute("class"))
    assert page.locator("#solutions button").nth(1).get_attribute("aria-pressed") == "true"
    dashes = page.evaluate("() => [0, 1].map((run) => String(robotraj.selection.look('elbow_joint', run).dash))")
    assert len(set(dashes)) == 2


def test_a_click_on_a_link_selects_its_joint(ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any) -> None:
    page = browser.open(replay(wave_plan(ur5, 2.0, amplitude=0.1), tmp_path / "page.html"), moment="#t=1")
    place = page.evaluate(PLACE, [0, "shoulder_lift_joint"])
    page.mouse.click(*place)
    assert page.evaluate("() => robotraj.selection.marked") == "shoulder_lift_joint"
    assert page.locator("#legend tr.marked").inner_text().startswith("shoulder_lift_joint")
    assert page.locator(".picked").inner_text() == "joint shoulder_lift_joint"
    page.keyboard.press("Escape")
    assert page.evaluate("() => robotraj.selection.marked") is None


def test_layers_are_shown_on_demand_and_the_centre_of_mass_is_the_robots(
    talos: Any, browser: Any, wave_plan: Any, tmp_path: Any
) -> None:
    plan = wave_plan(talos, 2.0, amplitude=0.3)
    path = replay(plan, tmp_path / "page.html")
    page = browser.open(path, moment="#t=1.25")
    visible = """(pattern) => { let count = 0; robotraj.view.roots[0].traverseVisible((node) => {
      if (node.name.startsWith(pattern)) count += 1; }); return count; }"""
    assert page.evaluate(visible, "visual ") > 30 and page.evaluate(visible, "collision ") == 0
    for layer in ("robot", "collision", "com", "frames"):
        page.locator(f"[data-layer={layer}]").click()
    assert page.evaluate(visible, "visual ") == 0 and page.evaluate(visible, "collision ") > 30
    page.evaluate("() => robotraj.seek(0.8)")
    ball = page.evaluate(
        """() => { let found; robotraj.view.roots[0].traverseVisible((node) => {
          if (node.userData.ball) found = node.userData.ball.position.toArray(); }); return found; }"""
    )
    expected = pin.centerOfMass(talos.model, talos.model.createData(), plan.phases[0].at(0.8).q[0])
    np.testing.assert_allclose(ball, expected, atol=2e-3)
    browser.check(path)


def test_obstacles_are_a_layer_and_keep_their_colour_beside_ghosts(browser: Any, tmp_path: Any) -> None:
    robot = rt.load("ur5")
    post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(1.2, 0.6, 0.3), name="post")
    free = rt.CollisionFree([post], self_collision=False)
    ends = rt.State(q=[0, -1.5, 1, -1, -1.5, 0], v=0), rt.State(q=[0.3, -1.5, 1, -1, -1.5, 0], v=0)
    solution = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort(), constraints=[free]), mesh=rt.Mesh(6))
    page = browser.open(replay([solution, solution], tmp_path / "page.html"))
    colors = page.evaluate(
        """() => robotraj.view.roots.map((root) => { let color; root.traverse((node) => {
          if (/^obstacle /.test(node.name)) node.traverse((m) => m.isMesh && (color = m.material.color.getHex())); });
          return color; })"""
    )
    assert colors[0] == colors[1] is not None
    page.locator("[data-layer=obstacles]").click()
    assert page.locator("[data-layer=obstacles]").get_attribute("aria-pressed") == "false"
