"""The page in a headless Chromium, offline: what is drawn is what Pinocchio says."""

import shutil
from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from robotraj.replay import replay

pytestmark = [pytest.mark.browser, pytest.mark.slow]

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
SWITCHES = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
READY = "() => window.robotraj !== undefined"
BOXES = """() => {
  const { viewer } = robotraj, THREE = MeshCat.THREE, boxes = {};
  viewer.scene.updateMatrixWorld(true);
  const back = viewer.scene.matrixWorld.clone().invert();
  viewer.scene_tree.find(["meshcat", "robot"]).object.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const name = mesh.parent.parent.name, matrix = back.clone().multiply(mesh.matrixWorld);
    const box = boxes[name] = boxes[name] || { box: new THREE.Box3(), sign: Math.sign(matrix.determinant()) };
    const position = mesh.geometry.attributes.position, v = new THREE.Vector3();
    for (let i = 0; i < position.count; i++) {
      box.box.expandByPoint(v.fromBufferAttribute(position, i).applyMatrix4(matrix));
    }
  });
  return Object.values(boxes).map((b) => [b.box.min.toArray(), b.box.max.toArray(), b.sign]);
}"""


class Browser:
    """Opens pages offline and remembers all they complained of and asked for."""

    def __init__(self, chromium: Any) -> None:
        self.chromium, self.complaints, self.requests = chromium, [], []

    def open(self, path: Any, width: int = 1300, height: int = 800) -> Any:
        context = self.chromium.new_context(
            offline=True, reduced_motion="reduce", viewport={"width": width, "height": height}
        )
        page = context.new_page()
        page.on("console", lambda m: self.complaints.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.goto(path.as_uri())
        page.wait_for_function(READY, timeout=90_000)
        return page

    def check(self, path: Any) -> None:
        assert self.complaints == []
        assert [url for url in self.requests if not url.startswith(("data:", "blob:"))] == [path.as_uri()]


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    if CHROMIUM is None:
        pytest.skip("no chromium, chromium-browser or google-chrome on the PATH")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=CHROMIUM, args=SWITCHES)
        yield started
        started.close()


@pytest.fixture
def browser(chromium: Any) -> Iterator[Browser]:
    opened = Browser(chromium)
    yield opened
    for context in chromium.contexts:
        context.close()


def drag(page: Any, chart: int, share: float, margins: tuple[float, float] = (56.0, 10.0)) -> float:
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


@pytest.mark.parametrize("name", ["ur5", "talos", "double_pendulum"])
def test_dragging_the_cursor_puts_every_joint_where_pinocchio_has_it(name, request, browser, wave_plan, tmp_path):
    robot = request.getfixturevalue(name)
    plan = wave_plan(robot, 3.0, start=0.5, phases=2)
    path = replay(plan, tmp_path / "page.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(0.5)")
    for chart, share in enumerate((0.2, 0.55, 0.93)):
        t = drag(page, chart, share)
        assert t == pytest.approx(0.5 + 3.0 * share, abs=0.02)
        data = placed(robot, next(p for p in plan.phases if t <= p.t0 + p.duration).at(t).q[0])
        poses = page.evaluate("() => robotraj.poses()")
        assert list(poses) == list(robot.model.names)[1:]
        for joint, pose in zip(range(1, robot.model.njoints), poses.values(), strict=True):
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
    assert browser.complaints == []


def test_a_system_shows_its_curves_without_a_view(block_plan, browser, tmp_path):
    path = replay(block_plan, tmp_path / "block.html")
    page = browser.open(path)
    page.evaluate("() => robotraj.seek(1.5)")
    assert page.locator(".plot").count() == 2
    assert not page.locator("#view").is_visible()
    assert page.evaluate("() => robotraj.poses()") == {}
    assert page.locator("#legend tbody tr").all_inner_texts() == [
        "x\t0.875 m\t",
        "v\t0.500 m/s\t",
        "u\t\t−1.000 N",
    ]
    browser.check(path)
