"""The process that expands macros: the path of a xacro file comes in, the XML of a URDF goes out."""

from __future__ import annotations

import errno
import json
import os
import re
import sys
import xml.dom.expatbuilder  # noqa: F401  before files are refused
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from robotraj._util.system.limited import serve

REFUSED = ("ctypes", "os.exec", "os.fork", "os.posix_spawn", "os.spawn", "os.system", "socket", "subprocess")
"""Beginnings of the events of Python that start or reach something else."""


def package(name: str, folders: Sequence[str]) -> str | None:
    """Return the folder of a package: one of that name, or one whose package.xml names it; None if there is none."""
    for folder in map(Path, folders):
        if (folder / name).is_dir():
            return str(folder / name)
        manifest = folder / "package.xml"
        stated = (
            re.search(r"<name>\s*([^<\s]+)", manifest.read_text("utf-8", "replace")) if manifest.is_file() else None
        )
        if name in (folder.name, stated and stated.group(1)):
            return str(folder)
    return None


def confine(folders: Sequence[str]) -> None:
    """Refuse from now on to write, to read files outside the folders, and to start processes."""

    def refuse(event: str, arguments: tuple[Any, ...]) -> None:
        if event.startswith(REFUSED):
            raise PermissionError(f"macros may not call {event}")
        if event == "open" and isinstance(arguments[0], (str, bytes)):
            place = Path(os.path.realpath(os.fsdecode(arguments[0])))
            if arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
                raise PermissionError(f"macros may not write '{place}'")
            if not any(place.is_relative_to(folder) for folder in folders):
                raise PermissionError(
                    errno.EACCES, "only package_dirs= or trust_paths=True let macros read", str(place)
                )

    sys.addaudithook(refuse)


def _expanded(question: bytes) -> bytes:
    asked = json.loads(question)
    xacro: Any = import_module("xacro")
    arguments: Any = import_module("xacro.substitution_args")
    with suppress(ImportError):
        import_module("yaml")
    elsewhere = arguments._eval_find

    def find(name: str) -> str:
        found = package(name, asked["folders"])
        if found is None and asked["trust"]:
            found = elsewhere(name)
        if found is None:
            raise ValueError(f"package {name!r} is not found; name the folder that contains it in package_dirs=")
        return str(found)

    # xacro looks packages up by ROS alone and has no argument for folders; xacrodoc replaces the same two entries.
    arguments._eval_find = arguments._eval_dict["find"] = find
    if not asked["trust"]:
        confine(asked["folders"])
    try:
        return bytes(xacro.process_file(asked["path"]).toxml(encoding="utf-8"))
    except Exception as error:
        cause = getattr(error, "exc", None)  # what xacro caught
        if cause is None:
            raise
        where = " ".join(str(getattr(error, "suffix", None) or "").split())
        raise cause if isinstance(cause, MemoryError) else ValueError(f"{cause} {where}".rstrip()) from error


if __name__ == "__main__":
    serve(_expanded)
