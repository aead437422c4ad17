"""Commands do what their help describes, write to the given paths, and report an error in one line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.cli.demos.table import DEMOS
from tests.cli.shell import completions, fail, run, succeed

PARTS = ("combinations", "functions", "linear", "steps")
"""Parts of the processor time that the interior-point method, the default for arms, reports."""


def test_demo_prints_the_phase_and_the_proof_and_writes_its_replay(here: Path) -> None:
    output = succeed("demo")
    assert "minimise Effort" in output and "position limit" in output
    assert "solved: objective 58.80" in output and "proved between the points" in output
    assert "PASSED" in output and f"wrote {here / 'cartpole.html'}" in output
    assert "</html>" in (here / "cartpole.html").read_text()[-200:]
    assert [path.name for path in here.iterdir()] == ["cartpole.html"]
    assert output.splitlines()[-1].endswith("'robotraj demo --list' names 27 more demos")
    listed = succeed("demo", "--list")
    assert all(f" {entry.name} " in listed for entry in DEMOS.values())


def test_demo_writes_to_the_given_path(here: Path) -> None:
    output = succeed("demo", "block", "--html", "a.html", "--save", "b", "--plot", "c.svg")
    assert "demos:" not in output
    assert all(f"wrote {here / name}" in output for name in ("a.html", "b.npz", "c.svg"))
    assert rt.load_solution("b.npz").duration == pytest.approx(2 * np.sqrt(10))
    assert "<svg" in (here / "c.svg").read_text()


def test_plan_moves_from_rest_to_rest(here: Path) -> None:
    succeed("plan", "two_link_arm", "--start", "-0.5,0.2", "--to", "elbow=1", "--duration", "5", "--save", "arm")
    solution = rt.load_solution("arm")
    first, last = solution.at(0.0), solution.at(5.0)
    robot = solution.problem.phases[0].robot
    assert robot is not None
    assert np.allclose(first.q, [-0.5, 0.2]) and np.allclose(last.q, [robot.neutral[0], 1.0])
    assert np.allclose(first.v, 0) and np.allclose(last.v, 0)


def test_plan_can_take_the_least_time_within_given_limits(here: Path) -> None:
    output = succeed("plan", "block", "--start=0", "--to=1", "--objective=duration", "--effort=0.25", "--save=a")
    assert "-0.25 .. 0.25" in output
    # 2 sqrt(distance mass / force) with a force that jumps; here it has to run from one bound to the other.
    assert 4.0 < rt.load_solution("a").duration < 4.002


def test_plan_groups_equal_rows_and_lists_each_on_request(here: Path) -> None:
    words = ("plan", "two_link_arm", "--to", "0.5,0.5", "--duration", "5")
    brief, full = succeed(*words), succeed(*words, "--rows")
    assert "shoulder, elbow" in brief and "--rows lists every row" in brief and "shoulder, elbow" not in full
    ends = rt.State(q=0, v=0), rt.State(q=0.5, v=0)
    phase = rt.Phase(rt.load("two_link_arm"), 5.0, *ends, rt.Effort(), name="two_link_arm, least effort")
    assert full.split("\n\n")[0] == str(phase)
    assert brief.splitlines()[-1].startswith("PASSED in ") and brief.splitlines()[-1].endswith(" s of processor time")
    assert "s of processor time" in " ".join(brief.split("solved:")[1].split("proved")[0].split())


def test_plan_keeps_links_off_the_obstacles_of_a_file(here: Path) -> None:
    (here / "scene.toml").write_text(
        '[[obstacles]]\ntype = "Box"\nsides = [0.2, 0.2, 0.2]\nposition = [0.6, 0.4, 0.4]\n'
    )
    robot = here / "arm.srdf"
    robot.write_text(
        '<robot name="a"><disable_collisions link1="forearm_link" link2="wrist_2_link" reason="x"/></robot>'
    )
    words = ("plan", "ur5", "--start=0,-1.3,1.6,-1.9,-1.57,0", "--to=1,-1.3,1.6,-1.9,-1.57,0", "--margin", "0.01")
    data = json.loads(succeed(*words, "--obstacles", "scene.toml", "--srdf", "arm.srdf", "--json", "--save", "a"))
    (constraint,) = rt.load_solution("a").problem.phases[0].constraints
    assert isinstance(constraint, rt.CollisionFree) and len(constraint.obstacles) == 1 and constraint.margin == 0.01
    assert constraint.srdf == (("forearm_link", "wrist_2_link"),)
    claims = {claim["name"]: claim["judgement"] for claim in data["claims"]}
    assert claims["obstacles"] == "holds" and data["verdict"] == "PASSED"
    (here / "empty.toml").write_text("")
    assert "has no obstacles" in fail(*words, "--obstacles", "empty.toml")


def test_plan_refines_when_a_tolerance_is_asked_for(here: Path) -> None:
    succeed("plan", "cartpole", "--to", "1,3.14159265", "--tolerance", "1e-5", "--save", "swing")
    assert len(rt.load_solution("swing").refinement) > 1


def test_plan_without_limits_imposes_none(here: Path) -> None:
    output = succeed("plan", "two_link_arm", "--to", "0.5,0.5", "--no-limits")
    assert "limit" not in output.split("solved:")[0]


def test_a_urdf_path_is_a_robot(here: Path) -> None:
    urdf = next(entry.urdf for entry in rt.robot.catalogue() if entry.name == "pendulum")
    assert "pivot" in succeed("show", urdf)
    output = succeed("plan", urdf, "--to", "1", "--duration", "1:3")
    assert "1 .. 3" in output and "PASSED" in output


def test_validate_and_replay_read_saved_solutions(here: Path) -> None:
    succeed("plan", "block", "--to", "1", "--duration", "4", "--intervals", "20", "--save", "swing")
    assert "PASSED" in succeed("validate", "swing.npz")
    assert f"wrote {here / 'swing.html'}" in succeed("replay", "swing.npz")
    assert f"wrote {here / 'slow.html'}" in succeed("replay", "swing", "slow.html", "--speed", "0.5")
    assert f"wrote {here / 'both.html'}" in succeed("replay", "swing", "both.html", "--with", "swing.npz")
    assert "2 solutions" in (here / "both.html").read_text()
    assert (here / "slow.html").read_text() != (here / "swing.html").read_text()
    succeed("replay", "swing.npz", "checked.html", "--validate")
    for page, verdict in (
        ("swing", "solved; nothing was proved"),
        ("checked", "validated by simulation; not judged: optimum"),
    ):
        assert f">{verdict}</dd>" in (here / f"{page}.html").read_text()
    result = run("replay", "swing.npz", "--periods", "3")
    assert result.exit_code != 0
    assert "ends elsewhere" in " ".join(result.output.split())


def test_a_proof_that_fails_exits_with_4(here: Path) -> None:
    succeed("demo", "block", "--save", "a")
    result = run("validate", "a.npz", "--local", "1e-12")
    assert result.exit_code == 4
    assert "FAILED" in result.stdout


def test_what_a_file_cannot_hold_is_a_note(here: Path) -> None:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], name="cart")
    phase = rt.Phase(system, 1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort())
    rt.plan(phase, rt.Mesh(4)).save("a")
    result = run("replay", "a.npz")
    assert result.exit_code == 0 and (here / "a.html").is_file()
    assert result.stderr.startswith("note: a.npz was loaded without the equations of system 'cart'")
    result = run("validate", "a.npz")
    assert result.exit_code == 2
    assert "error: The equations of system 'cart' are Python functions" in result.stderr


def test_robots_lists_the_catalogue() -> None:
    output = succeed("robots")
    for entry in rt.robot.catalogue():
        assert f" {entry.name} " in output
    found = succeed("robots", "cart-pole")
    assert "1 robot" in found and "cartpole" in found and "ur5" not in found


def test_show_prints_joints_limits_and_frames() -> None:
    output = succeed("show", "cartpole")
    assert "slider" in output and "[-2, 2]" in output and "20 N" in output
    assert "tip" in output.split("frames")[1]
    assert "licence:" in output
    assert all(len(line) <= 80 for robot in ("pendulum", "ur5") for line in succeed("show", robot).splitlines())
    assert "! Joints 'joint1', 'joint2' cannot be planned" in succeed("show", "double_pendulum")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["demo", "cartpol"], "no demo named 'cartpol'. Did you mean 'cartpole'"),
        (["show", "ur6"], "no robot named 'ur6'. Did you mean 'ur5'"),
        (["show", "absent.urdf"], "absent.urdf"),
        (["robots", "zzz"], "contains 'zzz'"),
        (["validate", "absent.npz"], "no file 'absent.npz'"),
        (["replay", "absent.npz"], "no file 'absent.npz'"),
        (["plan", "ur6"], "no robot named 'ur6'. Did you mean 'ur5'"),
        (["plan", "block"], "--to is missing"),
        (["plan", "ur5", "--to", "elbo=1"], "Did you mean 'elbow_joint'"),
        (["plan", "ur5", "--to", "1,2"], "takes 6 values"),
        (["plan", "block", "--to", "x"], "--to has 'x', which is no number"),
        (["plan", "block", "--to", "nan"], "--to has 'nan', which is no number"),
        (["plan", "two_link_arm", "--to", "elbow=1,2"], "mixes 'joint=value' with values alone"),
        (["plan", "block", "--to", "1", "--duration", "soon"], "--duration has 'soon'"),
        (["plan", "block", "--to", "1", "--duration", "3:1"], "lower bound lies above"),
        (["plan", "block", "--to", "50"], "outside its position limit"),
        (["plan", "ur5", "--to", "1 -1 1 0 0 0"], "a comma separates two, as in 0,1.57"),
        (["plan", "block", "--to", "1", "--duration", "0.5-3"], "least and greatest as in 0.5:3"),
        (["plan", "block", "--to", "1", "--no-limits", "--effort", "2"], "give it without --velocity and --effort"),
        (["plan", "block", "--to", "1", "--intervals", "0"], "a whole number from 1"),
        (["plan", "double_pendulum", "--to", "1,1"], "Joints 'joint1', 'joint2' cannot be planned"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_errors_are_one_line(here: Path, arguments: list[str], message: str) -> None:
    assert message in fail(*arguments)


@pytest.mark.parametrize("words", [["demo"], ["plan", "block", "--to=1"]], ids=["demo", "plan"])
@pytest.mark.parametrize(
    ("option", "name", "message"),
    [
        ("--html", "a.txt", "let it end in .html"),
        ("--html", "absent/a.html", "does not exist"),
        ("--html", "folder.html", "is a directory"),
        ("--save", "absent/a", "does not exist"),
        ("--plot", "a.xyz", "let it end in .png or .svg or .pdf"),
        ("--plot", "absent/a.png", "does not exist"),
    ],
)
def test_where_a_file_cannot_be_written_nothing_is_planned(
    here: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], option: str, name: str, message: str
) -> None:
    (here / "folder.html").mkdir()

    def planned(*_: Any, **__: Any) -> None:
        raise AssertionError("planned")

    monkeypatch.setattr(import_module("robotraj.planning.plan"), "plan", planned)
    assert message in (output := fail(*words, option, name)) and option in output


def test_a_failed_plan_prints_its_reason(here: Path) -> None:
    result = run("plan", "block", "--to", "10", "--start", "0", "--duration", "2", "--save", "last")
    assert result.exit_code == 3 and isinstance(result.exception, SystemExit)
    assert not rt.load_solution("last").success
    assert "was not solved" in result.stderr and "try: " in result.stderr


@pytest.mark.parametrize(
    "command", ["demo", "plan", "validate", "replay", "compile", "cache", "profile", "robots", "show"]
)
def test_every_command_explains_itself(command: str) -> None:
    assert command in succeed("--help")
    output = succeed(command, "--help")
    assert f"{command} [OPTIONS]" in output and "--help" in output
    if command == "demo":
        assert all(name in output for name in DEMOS)


@pytest.mark.parametrize("command", ["plan", "validate"])
def test_exit_codes_are_documented(command: str) -> None:
    for output in (succeed("--help"), succeed(command, "--help")):
        assert "2 bad input, 3 not solved, 4 solved but not proved" in " ".join(output.split())


def test_watching_a_plan_prints_its_address_and_needs_no_screen(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    result = run("plan", "two_link_arm", "--to", "elbow=1", "--duration", "5", "--watch", "--json")
    assert result.exit_code == 0
    assert "Watch the plan at http://127.0.0.1:" in result.stderr
    assert json.loads(result.stdout)["proved"]


def test_json_is_the_whole_output(here: Path) -> None:
    words = ("plan", "block", "--to", "1", "--duration", "2:4")
    data = json.loads(succeed(*words, "--json", "--save", "a", "--html", "a.html"))
    assert data["success"] and data["proved"] and data["status"] == "solved"
    assert data["duration"] == pytest.approx(4.0) and data["written"] == [str(here / "a.npz"), str(here / "a.html")]
    again = json.loads(succeed("validate", "a.npz", "--json"))
    assert again["proved"] and again["objective"] == data["objective"]
    assert again["verdict"] == "PASSED" and again["warnings"] == []
    assert 0.0 <= again["figures"]["local"] < 1e-3 and again["figures"]["violation"] < 1e-3
    assert again["figures"]["seconds"] > 0.0
    result = run("validate", "a.npz", "--local", "1e-15", "--json")
    assert result.exit_code == 4
    assert json.loads(result.stdout)["verdict"] == "FAILED"
    assert not json.loads(result.stdout)["proved"] and "simulated by itself" in json.loads(result.stdout)["failures"][0]


def test_json_lists_what_was_not_solved(here: Path) -> None:
    result = run("plan", "block", "--to", "10", "--start", "0", "--duration", "2", "--json")
    data = json.loads(result.stdout)
    assert result.exit_code == 3 and not data["success"] and data["proved"] is None and data["violations"]


def test_json_describes_a_robot() -> None:
    data = json.loads(succeed("show", "cartpole", "--json"))
    slider, pole = data["joints"]
    assert slider["position"] == [-2.0, 2.0] and slider["velocity"] is None and slider["actuated"]
    assert not pole["actuated"] and "tip" in str(data["frames"]) and data["nu"] == 1


def test_a_script_is_refused_with_the_command_that_runs_it(here: Path) -> None:
    for command in (["plan", "swing.py", "--to", "1"], ["show", "swing.py"], ["compile", "swing.py"]):
        output = fail(*command)
        assert "takes a robot" in output and output.endswith("python swing.py")


def test_a_plan_stops_at_its_time_limit(here: Path) -> None:
    result = run("plan", "ur5", "--to", "1,-1,1,0,0,0", "--intervals", "200", "--time-limit", "0.02", "--json")
    assert result.exit_code == 3
    assert json.loads(result.stdout)["status"] == "time limit"


def test_a_reader_that_closes_the_pipe_is_no_error(here: Path) -> None:
    program = "from robotraj.cli.app import app; app(['demo', 'block'])"
    reading, writing = os.pipe()
    os.close(reading)
    environment = {**os.environ, "PYTHONPATH": str(Path(rt.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, "-c", program], stdout=writing, stderr=subprocess.PIPE, text=True, env=environment
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")
    # The command continues; only its output is lost.
    assert (here / "block.html").is_file()


@pytest.mark.parametrize(
    ("words", "offered"), [("plan ur5", "ur5_limited"), ("demo five", "five_link_walking"), ("pro", "profile")]
)
def test_the_shell_completes_commands_robots_and_demos(words: str, offered: str) -> None:
    assert offered in completions(words)


def test_the_version_is_printed() -> None:
    assert succeed("--version").startswith("robotraj")


def test_python_m_robotraj_runs() -> None:
    command = [sys.executable, "-m", "robotraj", "robots", "ur5"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=Path(rt.__file__).parents[1])
    assert done.returncode == 0 and "ur5_limited" in done.stdout


@pytest.mark.slow
def test_compiled_functions_are_made_shown_used_and_cleared(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(here / "cache"))
    assert "least effort: 3 of 3 point functions compiled" in (printed := succeed("compile", "ur5"))
    assert "least duration: 3 of 3" in printed
    assert "6 functions," in succeed("cache")
    goal = "0.5,-0.5,0.5,-0.5,-0.5,0"
    succeed("plan", "ur5", "--to", goal, "--duration", "1", "--compiled", "--save", "plan.npz")
    assert "6 functions," in succeed("cache")
    assert "its problem: 0 of 3 point functions compiled" in succeed("compile", "plan.npz")
    printed = succeed("profile", "plan.npz")
    assert [line.split()[0] for line in printed.splitlines()][:4] == ["build", "compile", "setup", "solve"]
    assert "linear algebra and steps" in printed
    assert "freed" in succeed("cache", "--clear") and "0 functions, 0.0 MB" in succeed("cache")


def test_a_profile_of_a_plan_lists_its_times(here: Path) -> None:
    succeed("plan", "block", "--to", "1", "--duration", "4", "--save", "plan.npz")
    printed = [line.split() for line in succeed("profile", "plan.npz").splitlines()]
    assert [words[0] for words in printed] == ["build", "compile", "setup", "solve", *PARTS, "total"]
    seconds = [float(words[-3]) for words in printed[:-1]]
    assert sum(seconds[4:]) == pytest.approx(seconds[3], abs=1e-3)
    assert sum(seconds[:4]) == pytest.approx(float(printed[-1][1]), abs=1e-3)
