"""``robotraj init``, ``plan problem.toml``, ``export``, ``compare`` and ``schema``."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find
from tests.cli.shell import completions, fail, run, succeed

BLOCK = """
[robot]
source = "block"

[[phases]]
name = "push"
duration = 4.0
start = { q = 0, v = 0 }
end = { q = 1, v = 0 }
objective = "Effort"

[plan]
mesh = { intervals = 10 }

[replay]
title = "a block is pushed"

[output]
html = "push.html"
save = "push.npz"
"""


@pytest.fixture
def two(here: Path) -> tuple[Path, Path]:
    """Solutions of the same problem on two meshes."""
    (here / "problem.toml").write_text(BLOCK)
    file = rt.load_problem("problem.toml")
    return file.plan().save(here / "a.npz"), file.plan(mesh=rt.Mesh(20, rt.schemes.RadauIIA())).save(here / "b.npz")


@pytest.mark.parametrize("command", ["init", "export", "compare", "schema"])
def test_every_command_explains_itself(command: str) -> None:
    assert command in succeed("--help")
    assert f"{command} [OPTIONS]" in succeed(command, "--help")


def test_a_problem_file_is_planned_proved_and_written(here: Path) -> None:
    folder = here / "folder"
    folder.mkdir()
    (folder / "problem.toml").write_text(BLOCK)
    output = succeed("plan", "folder/problem.toml")
    assert "minimise Effort" in output and "PASSED" in output
    # Paths of the file start at its folder.
    assert "a block is pushed" in (folder / "push.html").read_text()
    assert rt.load_solution(folder / "push.npz").success


def test_options_of_the_shell_precede_those_of_the_file(here: Path) -> None:
    (here / "problem.toml").write_text(BLOCK)
    output = json.loads(succeed("plan", "problem.toml", "--json", "--save", "other.npz"))
    assert output["written"] == [str(here / "other.npz"), str(here / "push.html")] and output["intervals"] == {
        "push": 10
    }
    result = run("plan", "problem.toml", "--time-limit", "0.001", "--json")
    assert result.exit_code == 3 and json.loads(result.stdout)["status"] == "time limit"


def test_options_of_a_robot_are_refused_beside_a_file(here: Path) -> None:
    (here / "problem.toml").write_text(BLOCK)
    output = fail("plan", "problem.toml", "--to", "1", "--intervals", "20")
    assert "--to, --intervals are for a robot; problem.toml is a problem file" in output
    assert "--to is missing" in fail("plan", "block") and "robotraj init block" in fail("plan", "block")


def test_a_fault_of_a_file_is_one_line_with_line_and_key(here: Path) -> None:
    (here / "problem.toml").write_text(BLOCK.replace('"Effort"', '"Efort"'))
    assert fail("plan", "problem.toml").startswith(
        "error: problem.toml, line 10, phases[0].objective: There is no value or type named 'Efort'."
    )
    (here / "problem.toml").write_text(BLOCK.replace("push.html", "push.txt"))
    assert "let it end in .html" in fail("plan", "problem.toml")


def test_a_proof_that_fails_by_the_files_own_tolerance_exits_with_4(here: Path) -> None:
    (here / "problem.toml").write_text(BLOCK + "\n[validate]\nlocal = 1e-15\n")
    assert run("plan", "problem.toml").exit_code == 4


@pytest.mark.parametrize("robot", ["block", "ur5", "acrobot", "cartpole", "double_pendulum"])
def test_a_first_problem_plans_as_it_stands(here: Path, robot: str) -> None:
    assert "plan it with: robotraj plan problem.toml" in succeed("init", robot)
    output = succeed("plan", "problem.toml", "--json")
    assert json.loads(output)["proved"] and (here / f"{robot}.html").is_file()


def test_a_first_problem_of_a_urdf_names_it_from_its_own_folder(here: Path) -> None:
    (here / "mine.urdf").write_text(find("pendulum").urdf.read_text())
    (here / "plans").mkdir()
    succeed("init", "mine.urdf", "plans/first.toml")
    assert 'source = "../mine.urdf"' in (here / "plans" / "first.toml").read_text()
    assert json.loads(succeed("plan", "plans/first.toml", "--json"))["proved"]


@pytest.mark.parametrize(("robot", "gait"), [("five_link", "walk"), ("hopper", "jump")])
def test_a_first_gait_is_one_of_the_robots_feet(here: Path, robot: str, gait: str) -> None:
    succeed("init", robot, "--root", "planar")
    assert f'type = "{gait}"' in (here / "problem.toml").read_text()
    assert json.loads(succeed("plan", "problem.toml", "--json"))["proved"]


def test_an_existing_file_is_replaced_by_force_alone(here: Path) -> None:
    succeed("init", "block")
    assert "replace it with --force" in fail("init", "block")
    assert json.loads(succeed("init", "block", "--force", "--json"))["written"] == [str(here / "problem.toml")]
    assert "let it end in .toml" in fail("init", "block", "problem.txt")


@pytest.mark.parametrize("robot", ["ur5", "block"])
def test_every_line_that_a_first_problem_suggests_is_valid(here: Path, robot: str) -> None:
    succeed("init", robot)
    text = (here / "problem.toml").read_text()
    suggested = re.findall(r"^# (?:\[\[phases\.constraints\]\]\n(?:# .*\n)+|\w+ = .*\n)", text, re.MULTILINE)
    assert len(suggested) > 6
    for lines in suggested:
        plain = re.sub(r"^# ", "", lines, flags=re.MULTILINE)
        key = plain.split(" ")[0]
        # A suggestion replaces the same key in the table above it.
        changed = re.sub(rf"^{re.escape(key)} = .*\n(?=(?:.*\n)?{re.escape(lines)})", "", text, flags=re.MULTILINE)
        (here / "changed.toml").write_text(changed.replace(lines, plain, 1))
        assert rt.load_problem("changed.toml").problem.phases


@pytest.mark.parametrize(
    ("form", "suffix"),
    [("csv", "csv"), ("json", "json"), ("ros-yaml", "yaml"), ("ros-json", "json"), ("servo", "servo")],
)
def test_a_solution_is_exported(two: tuple[Path, Path], here: Path, form: str, suffix: str) -> None:
    out = here / f"out.{suffix}"
    assert succeed("export", "a.npz", out, "--format", form, "--rate", "100") == f"wrote {out}\n"
    lines = out.read_text().splitlines()
    if form in ("csv", "servo"):
        assert len(lines) == 401 + (form == "csv")
    elif form == "json":
        assert len(json.loads(out.read_text())["columns"]["t"]) == 401
    else:
        assert sum("time_from_start" in line for line in re.split(r"[{\n]", out.read_text())) == 401


def test_an_export_stands_beside_the_solution_and_holds_gains_on_request(two: tuple[Path, Path], here: Path) -> None:
    written = json.loads(succeed("export", "a.npz", "--gains", "--json"))["written"]
    assert written == [str(here / "a.csv")]
    with (here / "a.csv").open() as file:
        heads = next(csv.reader(file))
    assert any(head.startswith("gain.") for head in heads)
    assert "--gains are for --format csv and json" in fail("export", "a.npz", "--gains", "--format", "servo")
    assert "writes .yaml files" in fail("export", "a.npz", "a.csv", "--format", "ros-yaml")
    assert "no file 'c.npz'" in fail("export", "c.npz")


def test_two_solutions_are_compared(two: tuple[Path, Path], here: Path) -> None:
    output = succeed("compare", "a.npz", "b.npz")
    assert "intervals" in output and "setting mesh" in output and "measures are equal" in output
    rows = {row["name"]: row for row in json.loads(succeed("compare", "a.npz", "b.npz", "--json"))["measures"]}
    assert (rows["intervals"]["first"], rows["intervals"]["second"], rows["intervals"]["difference"]) == (10, 20, 10)
    first, second = (rt.load_solution(path) for path in two)
    assert rows["objective"]["difference"] == second.objective - first.objective
    assert rows["duration"]["equal"] and rows["status"]["equal"] and rows["verdict"]["first"] == "nothing proved"
    assert 0 < rows["use of effort limits"]["first"] <= 1
    assert rows["largest distance of q"]["second"] == pytest.approx(0.0, abs=1e-6)


def test_a_solution_equals_itself(two: tuple[Path, Path]) -> None:
    assert succeed("compare", "a.npz", "a.npz").startswith("a.npz and a.npz are equal in all")


def test_the_schema_is_printed(here: Path) -> None:
    assert "Constraints: AtEnd" in succeed("schema")
    output = succeed("schema", "GroundClearance")
    assert re.search(r"^frames .* required$", output, re.MULTILINE)
    assert json.loads(succeed("schema", "Box", "--json"))["entry"][0]["keys"][0]["default"] == "required"
    assert "Did you mean 'Box'" in fail("schema", "Bx")
    assert succeed("schema", "--markdown").startswith("### Tables")


@pytest.mark.parametrize(("words", "offered"), [("init ur5", "ur5_limited"), ("schema Ground", "GroundClearance")])
def test_the_shell_completes_robots_and_types(words: str, offered: str) -> None:
    assert offered in completions(words)
