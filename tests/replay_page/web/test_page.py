"""The page in a headless Chromium: drawn poses are those of Pinocchio."""

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

import robotraj as rt
from robotraj.replay_page.contacts import contact_scene
from robotraj.replay_page.write import replay
from robotraj.solution.conflict import Conflict
from robotraj.solution.cycles.gait_cycles import gait_cycles
from robotraj.solution.violation import Violation

pytestmark = [pytest.mark.browser, pytest.mark.slow]

BOXES = """() => {
  const { viewer } = robotraj, THREE = MeshCat.THREE, boxes = {};
  viewer.scene.updateMatrixWorld(true);
  const back = viewer.scene.matrixWorld.clone().invert();
  viewer.scene_tree.find(["meshcat", "solution 1", "robot"]).object.traverse((mesh) => {
    if (!mesh.isMesh) return;
    if (!/^visual /.test(mesh.parent.parent.name)) return;
    const name = mesh.parent.parent.name, matrix = back.clone().multiply(mesh.matrixWorld);
    const box = boxes[name] = boxes[name] || { box: new THREE.Box3(), sign: Math.sign(matrix.determinant()) };
    const position = mesh.geometry.attributes.position, v = new THREE.Vector3();
    for (let i = 0; i < position.count; i++) {
      box.box.expandByPoint(v.fromBufferAttribute(position, i).applyMatrix4(matrix));
    }
  });
  return Object.values(boxes).map((b) => [b.box.min.toArray(), b.box.max.toArray(), b.sign]);
}"""


def drag(page: Any, chart: int, share: float, margins: tuple[float, float] = (62.0, 12.0)) -> float:
    """Drag the time cursor in a chart to a share of its width; return the time the page then shows."""
    box = page.locator(".plot").nth(chart).bounding_box()
    left, width = box["x"] + margins[0], box["width"] - sum(margins)
    middle = box["y"] + box["height"] / 2.0
    page.mouse.move(left + 0.5 * width, middle)
    page.mouse.down()
    page.mouse.move(left + share * width, middle, steps=3)
    page.mouse.up()
    return float(page.evaluate("() => robotraj.time()"))


def placed(robot: Any, q: np.ndarray) -> pin.Data:
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    return data


def test_dragging_the_cursor_puts_every_joint_where_pinocchio_has_it(ur5, browser, wave_plan, tmp_path):
    plan = wave_plan(ur5, 3.0, start=0.5, phases=2)
    path = replay(plan, tmp_path / "page.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(0.5)")
    for chart, share in enumerate((0.2, 0.55, 0.93)):
        t = drag(page, chart, share)
        assert t == pytest.approx(0.5 + 3.0 * share, abs=0.02)
        data = placed(ur5, next(p for p in plan.phases if t <= p.t0 + p.duration).at(t).q[0])
        poses = page.evaluate("() => robotraj.poses()")
        assert list(poses) == list(ur5.model.names)[1:]
        for joint, pose in zip(range(1, ur5.model.njoints), poses.values(), strict=True):
            np.testing.assert_allclose(pose["position"], data.oMi[joint].translation, atol=1e-4)
            turn = Rotation.from_quat(pose["quaternion"]).as_matrix()
            np.testing.assert_allclose(turn, data.oMi[joint].rotation, atol=1e-4)
    browser.check(path)


def test_mirrored_meshes_of_talos_fill_the_space_they_should(talos, browser, wave_plan, tmp_path):
    plan = wave_plan(talos, 2.0)
    path = replay(plan, tmp_path / "talos.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(1.25)")
    data = placed(talos, plan.phases[0].at(1.25).q[0])
    expected = []
    for thing in talos.visual_model.geometryObjects:
        if not hasattr(thing.geometry, "vertices"):
            continue
        world = (data.oMi[thing.parentJoint] * thing.placement).homogeneous
        points = np.asarray(thing.geometry.vertices()) @ world[:3, :3].T + world[:3, 3]
        expected.append([points.min(axis=0), points.max(axis=0), np.sign(np.prod(thing.meshScale))])
    drawn = page.evaluate(BOXES)
    assert len(drawn) == len(talos.visual_model.geometryObjects)
    assert sum(sign < 0 for *_, sign in drawn) == 13
    for low, high, sign in expected:
        misses = [max(np.abs(low - a).max(), np.abs(high - b).max()) for a, b, s in drawn if s == sign]
        assert min(misses) < 2e-4
    browser.check(path)


def test_playing_moves_robot_cursor_and_clock_at_the_speed_asked_for(double_pendulum, browser, wave_plan, tmp_path):
    path = replay(wave_plan(double_pendulum, 4.0), tmp_path / "page.html", speed=0.3)
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(0)")
    before = page.evaluate("() => robotraj.poses()")
    page.locator("#play").click()
    page.wait_for_function("() => robotraj.time() > 0.2", timeout=30_000)
    page.locator("#play").click()
    t = page.evaluate("() => robotraj.time()")
    page.wait_for_timeout(200)
    assert page.evaluate("() => robotraj.time()") == t
    assert page.evaluate("() => robotraj.poses()") != before
    assert page.locator("#clock").inner_text().startswith(f"{t:.2f}")
    assert page.locator("#speed").input_value() == "0.3"
    assert float(page.locator("#scrubber").input_value()) == pytest.approx(t, abs=1e-6)
    browser.check(path)


def test_the_end_is_held_or_looped(double_pendulum, browser, wave_plan, tmp_path):
    path = replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html", speed=4.0)
    page = browser.open(path)
    page.locator("#loop").uncheck()
    page.evaluate("() => robotraj.seek(0.9)")
    page.locator("#play").click()
    page.wait_for_function("() => robotraj.time() === 1", timeout=30_000)
    page.wait_for_timeout(200)
    assert page.evaluate("() => robotraj.time()") == 1.0
    page.locator("#loop").check()
    page.locator("#play").click()
    page.wait_for_function("() => robotraj.time() < 0.9", timeout=30_000)
    browser.check(path)


def test_a_narrow_window_stacks_the_view_above_the_curves(double_pendulum, browser, wave_plan, tmp_path):
    path = replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html")
    wide, narrow = browser.open(path, 1300, 800), browser.open(path, 480, 900)
    boxes = [[page.locator(which).bounding_box() for which in ("#view", "#curves")] for page in (wide, narrow)]
    assert boxes[0][0]["x"] + boxes[0][0]["width"] <= boxes[0][1]["x"] + 1.0
    assert boxes[1][0]["y"] + boxes[1][0]["height"] <= boxes[1][1]["y"] + 1.0
    for page, width in ((wide, 1300), (narrow, 480)):
        assert page.evaluate("() => document.documentElement.scrollWidth") <= width
        assert page.locator("#pane canvas").bounding_box()["width"] > 300
    assert browser.console == []


def test_a_system_shows_its_curves_without_a_view(block_plan, browser, tmp_path):
    path = replay(block_plan, tmp_path / "block.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(1.5)")
    assert page.locator(".plot").count() == 2
    assert not page.locator("#view").is_visible()
    assert page.evaluate("() => robotraj.poses()") == {}
    rows = [text.split() for text in page.locator("#legend tbody tr").all_inner_texts()]
    assert page.locator("#legend thead th").all_inner_texts() == ["curve", "state", "control [N]"]
    assert rows == [["x", "0.875", "m"], ["v", "0.500", "m/s"], ["u", "−1.000"]]
    browser.check(path)


DRAWN = """() => {
  const [contacts] = robotraj.view.contacts, THREE = MeshCat.THREE;
  contacts.group.updateMatrixWorld(true);
  const back = robotraj.viewer.scene.matrixWorld.clone().invert();
  const place = (object, x, y, z) => object.localToWorld(new THREE.Vector3(x, y, z)).applyMatrix4(back).toArray();
  const arrow = ({ group, head }) => group.visible && [place(group, 0, 0, 0), place(head, 0, 0.5, 0)];
  const cone = ({ visible, children: [mantle] }) => {
    const { radius, height } = mantle.geometry.parameters;
    const [apex, open] = [place(mantle, 0, height / 2, 0), place(mantle, 0, -height / 2, 0)];
    return visible && { apex, open, mu: radius / height };
  };
  return {
    forces: contacts.arrows.map(arrow),
    impulses: contacts.blows.map(arrow),
    cones: contacts.cones.map(cone),
    curves: contacts.curves.map(({ line }) => line.opacity),
  };
}"""


def test_arrows_and_cones_stand_where_the_plan_has_the_forces(walk, browser, tmp_path):
    path = replay(walk, tmp_path / "walk.html", periods=3)
    page, course = browser.open(path), gait_cycles(walk, 3)
    scale = page.evaluate("() => robotraj.view.contacts[0].scale")
    expected = contact_scene(course, walk.phases[0].phase.robot, 1.0)
    assert scale == pytest.approx(page.evaluate("() => robotraj.view.contacts[0].data.length") / expected["unit"])
    for t, foot, number in ((0.3, "left_foot", 0), (1.0, "right_foot", 1), (1.75, "left_foot", 2)):
        page.evaluate(f"() => robotraj.seek({t})")
        drawn, now = page.evaluate(DRAWN), course.phases[number].at(t)
        tail, tip = (np.array(end) for end in drawn["forces"][number % 2])
        np.testing.assert_allclose((tip - tail) / scale, now.forces[foot], atol=2.0)
        np.testing.assert_allclose(tail, [0.5 * number, 0.08 - 0.16 * (number % 2), 0.0], atol=1e-3)
        assert drawn["forces"][1 - number % 2] is False
        assert [bool(cone) for cone in drawn["cones"]] == [k == number for k in range(3)]
        cone = drawn["cones"][number]
        np.testing.assert_allclose(cone["apex"], [0.5 * number, 0.08 - 0.16 * (number % 2), 0.0], atol=1e-6)
        assert cone["mu"] == pytest.approx(5.0)
        assert cone["open"][2] > 0.01
        assert drawn["curves"] == [1 if k == number else 0.3 for k in range(3)]
        assert drawn["impulses"] == [False] * 3
    page.evaluate("() => robotraj.seek(0.7)")
    (tail, tip), *others = page.evaluate(DRAWN)["impulses"]
    np.testing.assert_allclose(tail, [0.5, -0.08, 0.0], atol=1e-6)
    blow = [walk.impulses[0][f"impulse.left_foot.{axis}"] for axis in "xz"]
    np.testing.assert_allclose((np.array(tip) - tail)[[0, 2]] / scale * 0.1, blow, rtol=1e-3)
    assert others == [False] * 2
    browser.check(path)


def test_bars_and_marks_say_what_runs_and_what_is_drawn(walk, browser, tmp_path):
    path = replay(walk, tmp_path / "walk.html", periods=4)
    page = browser.open(path)
    assert page.locator("#bars .phase").all_inner_texts() == ["step", "step (mirrored)"] * 2
    colors = page.evaluate(
        "() => [...document.querySelectorAll('#bars .phase')].map((bar) => bar.style.cssText.match(/--own: [^;]+/)[0])"
    )
    assert colors[0] == colors[2] != colors[1] == colors[3]
    assert page.locator("#bars [data-contact=left_foot] b").count() == 2
    assert page.locator("#bars .impact").count() == 4
    marks = page.locator("#marks").inner_text()
    assert "body weight, 392 N, is 0.46 m long" in marks
    assert "39.2 N s is as long" in marks
    box = page.locator("#bars .area").bounding_box()
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 30.0)
    assert page.evaluate("() => robotraj.time()") == pytest.approx(2.1, abs=0.01)
    page.locator("#groups button", has_text="right").click()
    page.evaluate("() => robotraj.seek(1.0)")
    rows = {text.split()[0]: text for text in page.locator("#legend tbody tr:visible").all_inner_texts()}
    force = gait_cycles(walk, 2).phases[1].at(1.0).forces["right_foot"][2]
    shown = float(rows["right_foot"].split("\t")[-1].split()[0])
    assert shown == pytest.approx(force, abs=0.5)
    assert rows.keys() == {"right_hip", "right_knee", "right_foot"}
    browser.check(path)


def test_the_camera_follows_on_demand_and_far_limits_wait(walk, browser, tmp_path):
    path = replay(walk, tmp_path / "walk.html", periods=4)
    page = browser.open(path)
    camera = "() => robotraj.viewer.camera.position.toArray()"
    page.evaluate("() => robotraj.seek(0.35)")
    still = page.evaluate(camera)
    page.locator("#follow").click()
    here = page.evaluate(camera)
    assert here != still
    page.evaluate("() => robotraj.seek(1.75)")
    # Two steps on, 1 m along x; three.js has its y up.
    np.testing.assert_allclose(np.subtract(page.evaluate(camera), here), [1.0, 0.0, 0.0], atol=1e-3)
    page.locator("#home").click()
    np.testing.assert_allclose(page.evaluate(camera), still, atol=1e-6)
    assert page.locator("#follow").get_attribute("aria-pressed") == "false"
    buttons = page.locator(".chart button")
    assert [button.get_attribute("aria-pressed") for button in buttons.all()] == ["false", "false", "true", "true"]
    buttons.first.click()
    assert buttons.first.get_attribute("aria-pressed") == "true"
    browser.check(path)


def test_the_proof_is_shown_and_a_click_on_a_violated_row_moves_to_its_time(browser, tmp_path):
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, 4.0, rt.State(q=0, v=0), rt.State(q=[1, 0.5], v=0), rt.Effort(), name="reach")
    row = Violation("reach", "effort limit", "elbow", 0.4, 2.5, "N m", 1.0, "over")
    first = Conflict("reach", "effort limit, elbow", 0.0, 1.0, 3.5, "N m", 2.5, True)
    conflicts = (first, replace(first, name="velocity limit, elbow"))
    failed = replace(rt.plan(phase, mesh=rt.Mesh(6)), violation_list=(row,), conflicts=conflicts)
    report = rt.validate(failed)
    path = replay(failed, tmp_path / "page.html", report=report)
    page = browser.open(path)
    # The conflicting rows are visible without opening the proof.
    assert page.locator("header dd").last.inner_text() == str(first)
    page.keyboard.press("p")
    # Claims of the validation that fail stand before the number of violated rows.
    assert page.locator("#panel-proof .figure.bad").all_inner_texts()[-1] == "1"
    assert page.locator("#panel-proof p.bad").first.inner_text() == f"In conflict: {first}"
    assert page.locator("#panel-proof pre").inner_text().startswith("Validation of 'reach'")
    page.locator("#panel-proof li button").first.click()
    assert page.evaluate("() => robotraj.time()") == pytest.approx(0.4)
    browser.check(path)


def test_the_policy_blocks_every_source_but_the_page(block_plan, browser, tmp_path):
    page = browser.open(replay(block_plan, tmp_path / "block.html"))
    tries = """async () => {
      const blocked = [];
      document.addEventListener("securitypolicyviolation", (event) => blocked.push(event.effectiveDirective));
      document.head.append(Object.assign(document.createElement("script"), { textContent: "window.ran = true" }));
      document.body.append(Object.assign(new Image(), { src: "https://example.org/a.png" }));
      await fetch("https://example.org/").catch(() => null);
      setTimeout("window.ran = true");
      await new Promise((done) => setTimeout(done, 200));
      return [blocked.sort(), window.ran === undefined];
    }"""
    blocked, safe = page.evaluate(tries)
    assert safe, blocked
    assert {"script-src", "connect-src", "img-src", "script-src-elem"} <= set(blocked)


def test_names_of_javascript_objects_are_names_like_others(browser, tmp_path):
    names = ["__proto__", "constructor", "toString"]
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    visual = '<visual><geometry><box size="0.1 0.1 1"/></geometry></visual>'
    links = "".join(f'<link name="{k}">{inertial}{visual}</link>' for k in range(4))
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="{k}"/><child link="{k + 1}"/><origin xyz="0 0 1"/>'
        '<axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="9" effort="99"/></joint>'
        for k, name in enumerate(names)
    )
    urdf = tmp_path / "names.urdf"
    urdf.write_text(f'<robot name="names">{links}{joints}</robot>')
    robot = rt.load(urdf)
    phase = rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    path = replay(rt.plan(phase, mesh=rt.Mesh(6), check=False), tmp_path / "page.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(2)")
    poses = page.evaluate("() => JSON.parse(JSON.stringify(Object.entries(robotraj.poses())))")
    assert [name for name, _ in poses] == names
    placement = placed(robot, np.full(3, 0.5))
    for joint, (_, pose) in enumerate(poses, 1):
        np.testing.assert_allclose(pose["position"], placement.oMi[joint].translation, atol=1e-3)
    assert page.locator("#legend tbody tr").count() == 3
    browser.check(path)
