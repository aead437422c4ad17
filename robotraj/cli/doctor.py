"""``robotraj doctor``: what is installed, what works, and what is missing."""

from __future__ import annotations

import os
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import typer

from robotraj._util.errors import BuildMismatch, RobotrajError
from robotraj._util.values import dataclass
from robotraj.cli.exits import ExitCode
from robotraj.cli.options import JsonOption
from robotraj.cli.terminal import say, say_json

LIBRARIES = ("pin", "libpinocchio", "casadi", "example-robot-data", "numpy", "scipy", "meshcat")
"""Distributions that robotraj needs, beside itself."""
NOT_SOUGHT = "not looked for without the compiled module"
EXTRAS = {
    "mujoco": ("a second opinion, rt.witness.second_opinion", "pip install 'robotraj[mujoco]'"),
    "mcap": ("MCAP files of controllers", "pip install 'robotraj[mcap]'"),
    "pyarrow": ("Parquet files of studies", "pip install 'robotraj[study]'"),
}
"""Modules that more features need: what they serve, and how they are installed."""


@dataclass(frozen=True)
class Finding:
    """One line of the doctor.

    Attributes
    ----------
    name, value : str
    remedy : str
        What to do where something is missing; else empty.
    needed : bool
        Whether robotraj cannot plan without it.
    """

    name: str
    value: str
    remedy: str = ""
    needed: bool = False


def doctor(as_json: JsonOption = False) -> None:
    """Print versions, the compiled module, the compiler, the cache, and what is missing."""
    found = findings()
    broken = any(each.needed and each.remedy for each in found)
    if as_json:
        say_json(
            {
                "healthy": not broken,
                **{each.name: each.value for each in found},
                "missing": {each.name: each.remedy for each in found if each.remedy},
            }
        )
    else:
        width = max(len(each.name) for each in found)
        for each in found:
            say(f"{each.name:<{width}}  {each.value}" + (f"; {each.remedy}" if each.remedy else ""))
        say("robotraj cannot plan here" if broken else "robotraj can plan here")
    if broken:
        raise typer.Exit(ExitCode.ERROR)


def findings() -> list[Finding]:
    """Return what was found, in the order in which it is printed."""
    return [
        Finding("Python", f"{platform.python_version()} at {sys.prefix}"),
        Finding("system", f"{platform.system()} {platform.machine()}, {len(os.sched_getaffinity(0))} processors"),
        _itself(),
        *map(_library, LIBRARIES),
        _compiled_module(),
        _compiler(),
        _cache(),
        *(_extra(module, *about) for module, about in EXTRAS.items()),
    ]


def _itself() -> Finding:
    place = f"at {Path(__file__).parents[1]}"
    try:
        return Finding("robotraj", f"{version('robotraj')} {place}")
    except PackageNotFoundError:
        return Finding("robotraj", f"not installed, runs from its sources {place}")


def _library(name: str) -> Finding:
    try:
        return Finding(name, version(name))
    except PackageNotFoundError:
        return Finding(name, "not installed", "pip install robotraj", needed=True)


def _compiled_module() -> Finding:
    try:
        # The import of the room loads the module.
        from robotraj.native.build import load_native

        return Finding("compiled module", Path(str(load_native().__file__)).name)
    except RobotrajError as error:
        return Finding("compiled module", "does not load", str(error), needed=True)


def _compiler() -> Finding:
    try:
        from robotraj.native.engines.compiler import find_compiler

        return Finding("C compiler", str(find_compiler().command))
    except BuildMismatch:
        return Finding("C compiler", NOT_SOUGHT)
    except RobotrajError:
        return Finding("C compiler", "none", "only rt.engines.Compiled() needs one: apt install gcc")


def _cache() -> Finding:
    try:
        from robotraj.native.engines.compiled import Compiled

        kept = Compiled().open_cache()
    except BuildMismatch:
        return Finding("cache", NOT_SOUGHT)
    except (RobotrajError, OSError) as error:
        return Finding("cache", "cannot be used", str(error))
    return Finding("cache", f"{len(kept.libraries())} functions, {kept.size() / 1e6:.1f} MB in {kept.folder}")


def _extra(module: str, serves: str, remedy: str) -> Finding:
    if find_spec(module) is None:
        return Finding(module, f"not installed ({serves})", remedy)
    return Finding(module, f"{version(module)} ({serves})")
