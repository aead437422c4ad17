"""Expand a xacro file into a URDF with the package ``xacro``, which ``pip install xacro`` and xacrodoc bring.

Macros compute, include other files and read the environment. They run in a process of limited memory and time. Unless
paths are trusted, it opens files of the package and of ``package_dirs`` alone, and starts nothing.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.system.limited import LimitedProcess, NoAnswer

SECONDS = 20.0
"""Processor time of an expansion; the largest public descriptions take one second."""


def expanded(path: Path, folders: Sequence[Path], trust: bool, most: int) -> bytes:
    """Return the XML that the macros of a file make.

    Parameters
    ----------
    path : Path
    folders : sequence of Path
        Where ``$(find package)`` looks beside the file's own: folders above packages, or packages themselves.
    trust : bool
        Whether files elsewhere are included, and packages of ROS found.
    most : int
        Largest size [bytes].

    Raises
    ------
    InputError
        xacro is not installed, or it refuses the file.
    """
    made = path.name.removesuffix(".xacro").removesuffix(".urdf") + "_expanded.urdf"
    by_hand = f"'xacro {path.name} > {made}'"
    if find_spec("xacro") is None:
        raise InputError(
            f"{str(path)!r} is a xacro macro, not a URDF: rt.load expands it after 'pip install xacro'. Or expand it "
            f"with {by_hand}, a command of ROS, and load {made!r}."
        )
    places = list(dict.fromkeys(str(folder.resolve()) for folder in (path.parent, *folders)))
    question = json.dumps({"path": str(path.resolve()), "folders": places, "trust": trust})
    try:
        with LimitedProcess("robotraj.robot.macros") as process:
            answer = process.ask(question.encode(), SECONDS)
    except NoAnswer as reason:
        raise InputError(
            f"The macros of {str(path)!r} cannot be expanded: {reason}. Correct the file, or expand it with {by_hand}, "
            f"which takes values of its arguments as NAME:=VALUE, and load {made!r}."
        ) from None
    if len(answer) > most:
        raise InputError(f"The macros of {str(path)!r} make {len(answer) / 1e6:.1f} MB, above {most / 1e6:.1f} MB.")
    return answer
