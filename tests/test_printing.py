"""Public values print short: one line of at most 120 characters by ``repr``, at most 80 columns by ``str``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.printing import table
from tests.robots.cartpole import swing_up


@pytest.fixture(scope="module")
def solution() -> rt.Solution:
    first = rt.Phase(
        rt.load("two_link_arm"),
        (2.0, 6.0),
        rt.State(q=0, v=0),
        None,
        rt.Effort() + 0.1 * rt.Duration(),
        constraints=[rt.GroundClearance("tip", -3.0), rt.PathConstraint(lambda point: point.tau[0], -9, 9, name="cap")],
        parameters={"load": rt.between(0, 1)},
        name="reach",
    )
    second = first.with_(start=None, end=rt.State(q=[1, 0.5], v=0), name="return")
    return rt.plan(rt.Problem([first, second], [rt.Continuity(0, 1)]), mesh=rt.Mesh(6))


@pytest.fixture(scope="module")
def failed() -> rt.Solution:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    move = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([9, 0]), controls={"u": rt.between(-1, 1)})
    return rt.plan(move, mesh=rt.Mesh(4), check=False)


def values_in(value: Any, seen: set[int]) -> Iterator[Any]:
    """List the robotraj values that are reached from one by its fields, sequences and mappings."""
    if id(value) in seen:
        return
    seen.add(id(value))
    if type(value).__module__.startswith("robotraj"):
        yield value
    if is_dataclass(value) and not isinstance(value, type):
        inside = [getattr(value, entry.name) for entry in fields(value)]
    elif isinstance(value, dict):
        inside = list(value.values())
    else:
        inside = list(value) if isinstance(value, tuple | list) else []
    for entry in inside:
        yield from values_in(entry, seen)


def every(solution: rt.Solution) -> list[Any]:
    phase = solution.problem.phases[0]
    roots = [
        solution,
        solution.at(0.3),
        solution.at(np.linspace(0.0, 1.0, 40)),
        solution.at(0.3).x,
        phase.rows,
        phase.bound_constraints,
        solution.problem.bound_links,
        rt.Ipopt(),
        rt.Mesh(18, [rt.HermiteSimpson(), rt.schemes.RadauIIA(points=3)] * 9),
        rt.guess.Keyframes([0.0, 1.0], [rt.State(q=0), rt.State(q=1)]),
        rt.FramePosition("tip", np.linspace(0, 1, 3)),
    ]
    seen: set[int] = set()
    # Robots print as tables of joints.
    return [value for root in roots for value in values_in(root, seen) if not isinstance(value, rt.Robot)]


def assert_short(values: list[Any]) -> None:
    long = {line for line in map(repr, values) if "\n" in line or len(line) > 120 or re.search(r"0x[0-9a-f]{6}", line)}
    wide = {text for text in map(str, values) if max(map(len, text.splitlines() or [""])) > 80}
    assert not long and not wide


def test_every_value_prints_on_one_line_and_in_80_columns(solution: rt.Solution, failed: rt.Solution) -> None:
    values = every(solution) + every(failed)
    assert len({type(value) for value in values}) > 40
    assert_short(values)


def test_results_print_on_one_line_and_in_80_columns() -> None:
    phase, schemes = swing_up(), [rt.schemes.RadauIIA(points=n) for n in range(2, 12)]
    plan = rt.plan(phase, rt.Mesh(20))
    roots = [
        rt.validate(plan),
        rt.indirect.conditions(plan),
        rt.multistart(phase, starts=2, mesh=rt.Mesh(20), executor=ThreadPoolExecutor(1)),
        rt.planning.Compilation(functions=3, new=2, seconds=1.5, folder=Path("/a/cache/of/compiled/functions/engines")),
        rt.planning.Compilation(functions=0, new=0, seconds=0.0, folder=Path("/")),
        rt.Mesh(10, schemes),
    ]
    seen: set[int] = set()
    assert_short([value for root in roots for value in values_in(root, seen) if not isinstance(value, rt.Robot)])


def test_long_names_are_wrapped_inside_their_column() -> None:
    names = [f"a_state_with_a_very_long_name_of_{i}_and_of_no_use_at_all" for i in range(2)]
    system = rt.System(names, ["u"], lambda point: [point.x[names[1]], point.u["u"]])
    text = str(rt.Phase(system, 1.0, rt.State([0, 0])))
    assert max(map(len, text.splitlines())) <= 80
    assert all(name in re.sub(r"\s+", "", text) or name[:20] in text for name in names)


def test_what_a_repr_names(solution: rt.Solution) -> None:
    assert repr(solution.problem) == "<Problem of 'reach', 'return': 1 link>"
    assert repr(solution.problem.phases[0]).startswith("<Phase 'reach' of two_link_arm: 2 to 6 s, ")
    assert repr(rt.Effort() + 0.1 * rt.Duration()) == "Sum(parts=((1.0, Effort()), (0.1, Duration())))"
    assert (
        repr(rt.PathConstraint(lambda point: point.t, 0, 1)) == "PathConstraint(expression=<lambda>, lower=0, upper=1)"
    )


def test_a_wide_table_is_wrapped_at_blanks_then_in_cells_and_last_in_its_heading() -> None:
    heads, cells = ("acceleration", "interval"), ("shoulder_pan_joint", "[-1.2345, 1.2345]")
    assert table([heads, cells], 30)[1:] == ["shoulder_pan_joint  [-1.2345,", " " * 20 + "1.2345]"]
    narrow = table([heads, cells], 22)
    assert narrow[0].split() == ["acceleration", "interval"] and narrow[1].startswith("shoulder_pan")
    assert max(map(len, table([heads, cells], 18))) <= 18


def test_notebooks_show_tables_and_the_replay(solution: rt.Solution) -> None:
    phase = solution.problem.phases[0]._repr_html_()
    assert phase.count("<tr>") == len(str(solution.problem.phases[0]).splitlines()) - 1
    assert "effort limit" in phase and "<b>links</b>" in solution.problem._repr_html_()
    page = solution._repr_html_()
    assert page.startswith("<iframe sandbox='allow-scripts allow-downloads'") and "&lt;canvas" not in page[:200]
    assert "&lt;!DOCTYPE html&gt;" in page and "'" not in page.split("srcdoc='", 1)[1].split("'></iframe>", 1)[0]


def test_text_that_looks_like_html_is_escaped() -> None:
    system = rt.System(["<b>x"], ["u"], lambda point: [point.u["u"]])
    assert "<b>x" not in rt.Phase(system, 1.0, name="<i>")._repr_html_()


def test_names_cannot_control_a_terminal(tmp_path: Path) -> None:
    """Escape sequences, and letters that turn the direction of others, are printed as escapes; lines stay lines."""
    evil = "\x1b[31m\x07\x7f\x9b\u202e"
    text = rt.load("pendulum").geometry.urdf.read_text(encoding="utf-8")
    (joint,) = re.findall(r'<joint name="(\w+)" type="(?:revolute|continuous)"', text)
    (tmp_path / "evil.urdf").write_text(text.replace(f'"{joint}"', '"turn&#x7f;&#x9b;&#x202e;"'), encoding="utf-8")
    robot = rt.load(tmp_path / "evil.urdf")
    ball = rt.obstacles.Sphere(0.1, position=(9.0, 0.0, 0.0), name=evil)
    constraints = [rt.PathConstraint(lambda point: point.q[0], -3, 3, name=evil)]
    if robot.collision_model.ngeoms:
        constraints.append(rt.CollisionFree([ball]))
    ends = rt.State(q=0, v=0), rt.State(q=0.5, v=0)
    phase = rt.Phase(robot, 1.0, *ends, rt.Effort(), constraints, name=evil)
    plan = rt.plan(phase, mesh=rt.Mesh(4), check=False)
    block = rt.System([evil, "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], name=evil)
    printed = [robot, phase, rt.Problem([phase]), plan, rt.validate(plan), rt.Phase(block, 1.0, rt.State([0, 0]))]
    text = "\n".join(map(str, printed))
    assert "turn\\x7f\\x9b\\u202e" in text and "\\x1b[31m\\x07" in text
    assert not [letter for letter in text if not letter.isprintable() and letter != "\n"]
