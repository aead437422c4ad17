"""Digests are those of what is planned: code, closures, constants and robots, not places of files or processes."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.applications.studies.digest import digest_of

TEXT = """
import numpy as np, robotraj as rt
robot = rt.load("two_link_arm")
GAIN = {gain}
def inner(x):
    return GAIN * x
def make(case):
    # {comment}
    return rt.Phase(robot, {duration}, rt.State(q=inner(case["a"])), objective=rt.Effort())
"""


def made(gain: float = 2.0, duration: float = 1.0, comment: str = "", name: str = "first") -> Any:
    known: dict[str, Any] = {"__name__": name}
    exec(compile(TEXT.format(gain=gain, duration=duration, comment=comment), f"{name}.py", "exec"), known)
    return known["make"]


def test_equal_functions_of_two_files_have_one_digest() -> None:
    assert digest_of(made()) == digest_of(made(comment="another comment", name="second"))


@pytest.mark.parametrize("changes", [{"gain": 3.0}, {"duration": 2.0}])
def test_a_constant_that_is_read_anywhere_changes_the_digest(changes: dict[str, float]) -> None:
    assert digest_of(made(**changes)) != digest_of(made())


def test_a_closure_a_robot_and_an_array_change_the_digest() -> None:
    def close(value: object) -> Any:
        return lambda case: (case, value)

    robot = rt.load("two_link_arm")
    values = [1.0, 2.0, "1.0", np.arange(3.0), np.arange(4.0), robot, rt.load("two_link_arm", limits={"effort": 9.0})]
    digests = [digest_of(close(value)) for value in values]
    assert len(set(digests)) == len(values)
    assert digest_of(close(rt.load("two_link_arm"))) == digests[5]
    assert digest_of({"a", "b", "c"}) == digest_of({"c", "b", "a"})


@pytest.mark.slow
def test_another_process_finds_the_same_digest() -> None:
    code = TEXT.format(gain=2.0, duration=1.0, comment="") + (
        "from robotraj.applications.studies.digest import digest_of\n"
        "print(digest_of(make, {'x', 'y'}, {'mesh': rt.Mesh(4)}))"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": str(seed)}
        ).stdout
        for seed in (1, 2)
    }
    assert len(found) == 1
