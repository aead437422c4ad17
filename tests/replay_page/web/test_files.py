"""Files and links that the page makes by itself, offline."""

import csv
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence

from robotraj.replay_page.write import replay

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def saved(page: Any, item: str, target: Path) -> bytes:
    """Return what an item of the menu saves."""
    page.locator("#saving > button").click()
    with page.expect_download(timeout=120_000) as download:
        page.locator("#saving .items button", has_text=item).click()
    download.value.save_as(target)
    return target.read_bytes()


def test_values_as_csv_are_those_of_the_plan(ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any) -> None:
    plan = wave_plan(ur5, 2.0, phases=2)
    plan.phases[0].phase.name = 'up, "slowly"'
    path = replay(plan, tmp_path / "page.html")
    page = browser.open(path)
    saved(page, "CSV", tmp_path / "values.csv")
    with (tmp_path / "values.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head[:3] == ["t [s]", "phase", "q.shoulder_pan_joint [rad]"] and len(head) == 2 + 3 * 6
    assert {row[1] for row in rows} == {'up, "slowly"', "wave 2"}
    times = np.array([float(row[0]) for row in rows])
    values = np.array([[float(cell) for cell in row[2:]] for row in rows])
    for part, chosen in zip(plan.phases, (times <= 1.0, times > 1.0), strict=True):
        sample = part.at(times[chosen])
        expected = np.hstack([sample.q, sample.v, sample.tau])
        np.testing.assert_allclose(values[chosen], expected, rtol=1e-4, atol=1e-5)
    browser.check(path)


def test_pictures_show_the_robot_and_the_curves(ur5: Any, browser: Any, wave_plan: Any, tmp_path: Any) -> None:
    path = replay(wave_plan(ur5, 2.0), tmp_path / "page.html")
    page = browser.open(path)
    for item, least in (("robot (PNG)", 20_000), ("curves (PNG)", 50_000)):
        picture = saved(page, item, tmp_path / "picture.png")
        assert picture.startswith(b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", picture[16:24])
        assert min(width, height) > 400
        # A picture of one colour would be far smaller.
        assert len(picture) > least
    browser.check(path)


def test_a_video_is_recorded_once_from_start_to_end(double_pendulum: Any, browser: Any, wave_plan: Any, tmp_path: Any):
    path = replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html", speed=2.0)
    page = browser.open(path)
    video = saved(page, "Video", tmp_path / "video")
    assert len(video) > 2000
    assert video[4:8] == b"ftyp" or video.startswith(b"\x1aE\xdf\xa3")
    assert page.evaluate("() => [robotraj.time(), robotraj.player.playing]") == [1.0, False]
    browser.check(path)


def test_a_gif_shows_the_whole_motion(double_pendulum: Any, browser: Any, wave_plan: Any, tmp_path: Any) -> None:
    path = replay(wave_plan(double_pendulum, 2.0), tmp_path / "page.html", speed=2.0)
    page = browser.open(path)
    saved(page, "GIF", tmp_path / "motion.gif")
    with Image.open(tmp_path / "motion.gif") as animation:
        frames = [np.asarray(each.convert("RGB")).astype(int) for each in ImageSequence.Iterator(animation)]
        seconds = sum(each.info["duration"] for each in ImageSequence.Iterator(animation)) / 1000
    assert len(frames) == 17 and seconds == pytest.approx(1.0, abs=0.06)  # 2 s at twice the speed
    assert frames[0].shape[1] == 480
    moved = [np.mean(np.abs(one - two).max(axis=2) > 30) for one, two in zip(frames, frames[1:], strict=False)]
    assert min(moved) > 0.0 and max(moved) < 0.5
    # A frame is what the page shows at its time, but for the bits of a palette.
    page.evaluate("() => robotraj.seek(1.0)")
    (tmp_path / "robot.png").write_bytes(saved(page, "robot (PNG)", tmp_path / "robot.png"))
    with Image.open(tmp_path / "robot.png") as picture:
        shown = np.asarray(picture.convert("RGB").resize((480, frames[8].shape[0]))).astype(int)
    assert np.mean(np.abs(shown - frames[8])) < 12
    browser.check(path)


def test_an_embedded_page_shows_the_robot_and_its_playback(
    double_pendulum: Any, browser: Any, wave_plan: Any, tmp_path: Any
) -> None:
    path = replay(wave_plan(double_pendulum, 1.0), tmp_path / "page.html")
    page = browser.open(path, width=420, height=300, moment="#embed&t=0.25")
    for name, seen in (
        ("#pane canvas", True),
        ("#play", True),
        ("#scrubber", True),
        ("header", False),
        ("#side", False),
    ):
        assert page.locator(name).first.is_visible() == seen, name
    assert page.evaluate("() => robotraj.time()") == pytest.approx(0.25)
    size = "() => [document.documentElement.scrollHeight, document.documentElement.scrollWidth]"
    assert page.evaluate(size) == [300, 420]
    assert page.locator("#pane canvas").bounding_box()["height"] > 220
    browser.check(path)


def test_a_link_opens_the_same_moment_and_view(walk: Any, browser: Any, tmp_path: Any) -> None:
    path = replay(walk, tmp_path / "walk.html", periods=4)
    page = browser.open(path, moment="#t=0.42")
    assert page.evaluate("() => robotraj.time()") == pytest.approx(0.42)
    assert not page.evaluate("() => robotraj.player.playing")
    page.locator("#groups button", has_text="right").click()
    page.evaluate("() => robotraj.selection.show(0.2, 1.2)")
    page.locator("#follow").click()
    page.keyboard.press("p")
    moment = page.evaluate("() => robotraj.link.write()")
    other = browser.open(path, moment=moment)
    state = """() => [robotraj.time(), robotraj.selection.group, robotraj.selection.window,
      document.querySelector("[role=tab][aria-selected=true]").id, robotraj.viewer.camera.position.toArray()]"""
    for one, two in zip(page.evaluate(state), other.evaluate(state), strict=True):
        assert one == (pytest.approx(two, abs=2e-3) if not isinstance(one, str) else two)
    other.evaluate("() => { location.hash = '#t=1.1&group=left'; }")
    other.wait_for_function("() => Math.abs(robotraj.time() - 1.1) < 1e-9")
    # Invalid text is ignored.
    other.evaluate("() => { location.hash = '#t=never&window=1&group=none&camera=1,2'; }")
    assert other.evaluate("() => robotraj.time()") == pytest.approx(1.1)
    browser.check(path)
