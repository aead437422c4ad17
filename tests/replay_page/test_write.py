import base64
import gzip
import json
import re
import socket
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest

from robotraj._util.errors import InputError, UnknownName
from robotraj.replay_page.write import replay


class Elements(HTMLParser):
    """Every element with its attributes, and the text of those that have an id."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found, self.texts, self._open = [], {}, None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        self._open = dict(attrs).get("id")

    def handle_data(self, data):
        if self._open:
            self.texts[self._open] = self.texts.get(self._open, "") + data

    def handle_endtag(self, tag):
        self._open = None


def data_of(path) -> dict:
    return json.loads(gzip.decompress(base64.b64decode(Elements(path.read_text()).texts["data"])))


def run_of(path) -> dict:
    """The only solution of a page."""
    (run,) = data_of(path)["runs"]
    return run


def test_five_seconds_of_ur5_take_less_than_five_megabytes(ur5, wave_plan, tmp_path):
    path = replay(wave_plan(ur5, 5.0), tmp_path / "ur5.html")
    assert path == tmp_path / "ur5.html"
    assert 1_000_000 < path.stat().st_size < 5_000_000


@pytest.mark.slow
def test_a_minute_of_talos_takes_less_than_fifteen_megabytes(talos, wave_plan, tmp_path):
    assert replay(wave_plan(talos, 60.0), tmp_path / "talos.html").stat().st_size < 15_000_000


def test_the_page_refers_to_nothing_outside_itself(ur5, wave_plan, tmp_path):
    page = Elements(replay(wave_plan(ur5, 1.0), tmp_path / "page.html").read_text())
    for tag, attributes in page.found:
        for key in ("src", "href", "srcset", "action", "data", "poster"):
            assert attributes.get(key, "data:").startswith("data:"), (tag, attributes)
    styles = "".join(re.findall(r"<style>(.*?)</style>", (tmp_path / "page.html").read_text(), re.S))
    assert "url(" not in styles
    assert "@import" not in styles


def test_writing_starts_no_process_and_opens_no_socket(ur5, wave_plan, tmp_path, monkeypatch):
    def refuse(*args, **kwargs):
        raise AssertionError("the replay reached outside")

    monkeypatch.setattr(subprocess.Popen, "__init__", refuse)
    monkeypatch.setattr(socket.socket, "bind", refuse)
    monkeypatch.setattr(socket.socket, "connect", refuse)
    assert replay(wave_plan(ur5, 1.0), str(tmp_path / "page.html")).is_file()


def test_the_same_solution_gives_the_same_page(ur5, wave_plan, tmp_path):
    pages = [replay(wave_plan(ur5, 1.0), tmp_path / f"{k}.html").read_bytes() for k in range(2)]
    assert pages[0] == pages[1]


def test_the_heading_names_the_problem_and_the_method(ur5, wave_plan, tmp_path):
    plan = replace(
        wave_plan(ur5, 2.5, phases=2),
        success=False,
        status=SimpleNamespace(name="ITERATION_LIMIT", value="iteration <limit>"),
    )
    path = replay(plan, tmp_path / "page.html", title="Pick & place <1>")
    text = path.read_text()
    assert "<h1>Pick &amp; place &lt;1&gt;</h1>" in text
    assert "wave 1 → wave 2" in text
    assert '<dd id="status" class="status bad">iteration &lt;limit&gt;</dd>' in text
    assert "<dd>2.5 s</dd>" in text
    assert "<dd>12.3457</dd>" in text


def test_the_licences_of_the_viewer_travel_with_it(ur5, wave_plan, tmp_path):
    text = replay(wave_plan(ur5, 1.0), tmp_path / "page.html").read_text()
    assert "Three.js Authors" in text
    assert "Permission is hereby granted" in text


def test_names_with_slashes_and_tags_cannot_break_the_page(double_pendulum, wave_plan, tmp_path):
    plan = wave_plan(double_pendulum, 1.0)
    plan.phases[0].phase.name = "</script><b>up"
    elements = Elements(replay(plan, tmp_path / "page.html").read_text())
    assert "b" not in [tag for tag, _ in elements.found]
    assert run_of(tmp_path / "page.html")["phases"][0]["name"] == "</script><b>up"


def test_a_name_that_utf8_cannot_encode_is_escaped(double_pendulum, wave_plan, tmp_path):
    plan = wave_plan(double_pendulum, 1.0)
    plan.phases[0].phase.name = "\udcff"
    assert run_of(replay(plan, tmp_path / "page.html"))["phases"][0]["name"] == "\udcff"


def test_a_system_gets_its_curves_and_no_viewer(block_plan, tmp_path):
    path = replay(block_plan, tmp_path / "block.html", speed=0.5)
    data = data_of(path)
    (run,) = data["runs"]
    assert run["scene"] is None
    assert data["speed"] == 0.5
    assert [c["title"] for c in run["charts"]] == ["States", "Controls"]
    assert run["groups"] == [{"name": "variables", "root": False, "labels": ["x", "v", "u"]}]
    assert path.stat().st_size < 200_000


def test_traces_follow_the_frames_asked_for(ur5, wave_plan, tmp_path):
    plan = wave_plan(ur5, 2.0)
    traces = lambda **options: run_of(replay(plan, tmp_path / "page.html", **options))["scene"]["traces"]  # noqa: E731
    assert [t["frame"] for t in traces()] == ["tool0"]
    assert [t["frame"] for t in traces(traces=["forearm_link", "tool0"])] == ["forearm_link", "tool0"]
    assert [t["frame"] for t in traces(traces="forearm_link")] == ["forearm_link"]
    assert traces(traces=()) == []
    assert traces(traces=["base_link"]) == []  # it never moves


def test_the_camera_frames_the_robot_over_the_whole_motion(double_pendulum, wave_plan, tmp_path):
    small = run_of(replay(wave_plan(double_pendulum, 4.0, amplitude=0.1), tmp_path / "a.html"))["scene"]["hull"]
    large = run_of(replay(wave_plan(double_pendulum, 4.0, amplitude=1.5), tmp_path / "b.html"))["scene"]["hull"]
    assert np.all(np.ptp(large, axis=0) >= np.ptp(small, axis=0) - 1e-3)
    assert np.ptp(large, axis=0).max() > 1.3 * np.ptp(small, axis=0)[np.argmax(np.ptp(large, axis=0))]


def test_planning_alone_does_not_load_the_viewer():
    script = "import sys, robotraj; print([m for m in ('meshcat', 'trimesh') if m in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("path", "options", "message"),
    [
        ("page.txt", {}, r"let it end in \.html"),
        ("page", {}, r"let it end in \.html"),
        ("nowhere/page.html", {}, "does not exist"),
        ("page.html", {"speed": 0.0}, "speed"),
        ("page.html", {"speed": float("nan")}, "speed"),
        ("page.html", {"speed": "fast"}, "speed"),
        ("page.html", {"fps": "30"}, "fps"),
        ("page.html", {"fps": float("nan")}, "fps"),
        ("page.html", {"fps": 0}, "fps"),
        ("page.html", {"fps": 29.97}, "fps"),
        ("page.html", {"fps": True}, "fps"),
    ],
)
def test_bad_input_is_named_before_anything_is_written(ur5, wave_plan, tmp_path, path, options, message):
    with pytest.raises(InputError, match=message):
        replay(wave_plan(ur5, 1.0), tmp_path / path, **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("count", "options", "message"),
    [
        (0, {}, "1 to 4 solutions; got 0"),
        (5, {}, "1 to 4 solutions; got 5"),
        (2, {"labels": ["one"]}, "one name for each of the 2"),
        (2, {"labels": "ab"}, "one name for each of the 2"),
    ],
)
def test_the_number_of_solutions_and_of_their_labels_is_checked(block_plan, tmp_path, count, options, message):
    with pytest.raises(InputError, match=message):
        replay([block_plan] * count, tmp_path / "page.html", **options)


def test_several_solutions_share_a_page_and_their_meshes(ur5, wave_plan, tmp_path):
    one, two = wave_plan(ur5, 2.0), wave_plan(ur5, 3.0, seed=1)
    alone = replay(one, tmp_path / "one.html").stat().st_size
    path = replay([one, two, one], tmp_path / "three.html", labels=["slow", "fast", "again"])
    runs = data_of(path)["runs"]
    assert [run["label"] for run in runs] == ["slow", "fast", "again"]
    assert [run["end"] for run in runs] == pytest.approx([2.0, 3.0, 2.0])
    assert len({run["tint"] for run in runs}) == 3
    assert [run["scene"]["root"] for run in runs] == [["meshcat", f"solution {k}"] for k in (1, 2, 3)]
    assert path.stat().st_size < 1.4 * alone


def test_a_directory_is_no_file(ur5, wave_plan, tmp_path):
    (tmp_path / "page.html").mkdir()
    with pytest.raises(InputError, match="is a directory"):
        replay(wave_plan(ur5, 1.0), tmp_path / "page.html")


def test_an_unknown_frame_is_named(ur5, wave_plan, tmp_path):
    with pytest.raises(UnknownName, match="'tool'"):
        replay(wave_plan(ur5, 1.0), tmp_path / "page.html", traces=["tool"])


def test_frames_of_a_system_are_refused(block_plan, tmp_path):
    with pytest.raises(InputError, match="traces="):
        replay(block_plan, tmp_path / "page.html", traces=["tip"])


def test_phases_of_two_robots_are_refused(ur5, double_pendulum, wave_plan, tmp_path):
    one, two = wave_plan(ur5, 1.0), wave_plan(double_pendulum, 1.0, start=1.0)
    with pytest.raises(InputError, match="double_pendulum.*ur5"):
        replay(replace(one, phases=one.phases + two.phases), tmp_path / "page.html")
