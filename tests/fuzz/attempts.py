"""The child process of ``guard.py``: loads hostile files and prints one JSON line with the outcome of each attempt."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import warnings

WRITES = {
    "os.mkdir",
    "os.rename",
    "os.remove",
    "os.rmdir",
    "os.chmod",
    "os.chown",
    "os.link",
    "os.symlink",
    "os.truncate",
    "os.system",
    "os.exec",
    "os.fork",
    "os.posix_spawn",
    "subprocess.Popen",
    "socket.connect",
    "pickle.find_class",
}
"""Audit events that no loading raises; see the table of audit events of Python's library."""

CREATE = os.O_WRONLY | os.O_RDWR | os.O_CREAT

seen: list[str] = []


def watch(event: str, arguments: tuple[object, ...]) -> None:
    """Keep every event that writes, runs or connects."""
    if event in WRITES or (event == "open" and isinstance(arguments[2], int) and arguments[2] & CREATE):
        seen.append(f"{event} {str(arguments[:1])[:200]}")


def load_saved(path: str) -> None:
    """Load a solution, and read what a user would."""
    import numpy as np

    import robotraj as rt

    solution = rt.load_solution(path)
    _ = repr(solution), str(solution), solution.violations(top=3)
    solution.at(np.linspace(0.0, solution.duration, 5))


def load_urdf(path: str) -> None:
    """Load a robot, print it, read its shapes and bind it to a phase."""
    import robotraj as rt

    robot = rt.load(path)
    _ = str(robot), robot.limits.warnings(robot.actuated), robot.visual_model, robot.collision_model
    if robot.nu:
        str(rt.Phase(robot, 1.0, objective=rt.Effort()))


def load_problem(path: str) -> None:
    """Read a problem file and print its problem."""
    import robotraj as rt

    str(rt.load_problem(path))


def load_srdf(path: str) -> None:
    """Read the pairs of an SRDF."""
    from robotraj.robot.collision.link_pairs import read_srdf

    read_srdf(path)


def load_mesh(path: str) -> None:
    """Read a mesh."""
    from pathlib import Path

    from robotraj.robot.meshes.reading import read_mesh_file

    read_mesh_file(Path(path))


KNOWN = {
    "saved": load_saved,
    "urdf": load_urdf,
    "mjcf": load_urdf,
    "problem": load_problem,
    "srdf": load_srdf,
    "mesh": load_mesh,
}
OWN_PLACE = ("mesh", "mjcf")
"""What is read in a process of its own, or copied to a folder of its own, of which nothing may be left."""


def has_own_place(kind: str, path: str) -> bool:
    """Whether a file is read in a place of its own; a process expands the macros of xacro."""
    if kind in OWN_PLACE:
        return True
    with open(path, "rb") as file:
        text = file.read()
    return kind == "urdf" and any(mark in text for mark in (b"xacro", b"${", b"$("))


def main() -> None:
    """Make one attempt for each line of the standard input."""
    answers = os.fdopen(os.dup(1), "w")
    # Warnings that parsers print must not be mixed with the results.
    os.dup2(2, 1)
    warnings.simplefilter("ignore")
    import robotraj as rt

    for name, load in KNOWN.items():
        # Modules that are imported later write nothing, but are read from other folders.
        with contextlib.suppress(rt.InputError):
            load(os.path.join(os.sep, "nowhere", name + ".urdf"))
    sys.addaudithook(watch)
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        kind, path = json.loads(line)
        seen.clear()
        answer, text = "loaded", ""
        try:
            KNOWN[kind](path)
        except rt.InputError as error:
            answer, text = "refused", str(error)
            if not text.strip() or len(text) > 20_000:
                answer = "raw"
        except BaseException as error:
            import traceback

            where = traceback.extract_tb(error.__traceback__)[-1]
            answer, text = "raw", f"{type(error).__name__}: {str(error)[:300]} ({where.filename}:{where.lineno})"
        events = seen.copy()
        if events and not has_own_place(kind, path):
            answer, text = "wrote", "; ".join(events[:5])
        print(json.dumps([answer, text]), file=answers, flush=True)


if __name__ == "__main__":
    main()
