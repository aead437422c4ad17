"""The file: a NumPy ``.npz`` of plain arrays and one JSON text, never a pickle.

``about`` says what the file is, ``solution`` is the JSON, and every other entry is an array that the JSON
refers to, or a Pinocchio model as text. Plain NumPy reads it:
``np.load("swing.npz")["phases.0.trajectory.x.values"]``.
"""

from __future__ import annotations

import json
import os
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from robotraj._util.errors import InputError, RobotrajError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings
from robotraj.solution.storage.codec import NotPlainData, Packer, Unpacker
from robotraj.solution.storage.problems import check_fit, pack_problem, unpack_problem

FORMAT = "robotraj solution"
VERSION = 2
"""Raised whenever older versions could not read the file rightly."""

ADVICE = "give the path of a file that solution.save(path) wrote."


@dataclass(frozen=True, eq=False)
class Contents(OneLine):
    """What a file holds.

    Attributes
    ----------
    problem : Problem
    phases : sequence of mapping
        For each phase the plain data of its solution, by name.
    facts : mapping
        Plain data of the whole solution, by name.
    settings : Settings or None
        None also where they could not be written, as those of a solver that is not plain data.
    """

    problem: Problem
    phases: Sequence[Mapping[str, Any]]
    facts: Mapping[str, Any]
    settings: Settings | None


def write(path: str | os.PathLike[str], contents: Contents) -> Path:
    """Write a file; ``.npz`` is appended where it is missing.

    Returns
    -------
    pathlib.Path
        The file, absolute. An older one is replaced, once the new one is complete.

    Raises
    ------
    InputError
        The directory does not exist, or the path is one.
    """
    target = Path(path).expanduser().absolute()
    if target.suffix != ".npz":
        target = target.with_name(target.name + ".npz")
    if not target.parent.is_dir():
        raise InputError(f"Cannot save: the directory {str(target.parent)!r} does not exist; create it first.")
    if target.is_dir():
        raise InputError(f"Cannot save: {str(target)!r} is a directory; name a file.")
    packer = Packer()
    data = {
        "problem": pack_problem(contents.problem, packer),
        "phases": [packer.pack(dict(phase), f"phases.{i}") for i, phase in enumerate(contents.phases)],
        "facts": packer.pack(dict(contents.facts), "facts"),
        "settings": _packed_settings(contents.settings, packer),
    }
    about = {"format": FORMAT, "version": VERSION, "robotraj": _own_version()}
    partial = target.with_name(target.name + ".part")
    try:
        with partial.open("wb") as file:
            np.savez_compressed(file, about=_text(about), solution=_text(data), **packer.arrays)  # type: ignore[arg-type]
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return target


def read(path: str | os.PathLike[str], problem: Problem | None = None) -> Contents:
    """Read a file that ``write`` wrote.

    Parameters
    ----------
    path : path
        With or without ``.npz``.
    problem : Problem, optional
        Used in place of the file's own; its phases must have the same variables.

    Raises
    ------
    InputError
        No such file, a file of another kind or version, a damaged one, or one of another problem.
    """
    source = _existing(Path(path).expanduser())
    arrays = _arrays(source)
    data = json.loads(str(arrays["solution"]))
    unpacker = Unpacker(arrays)
    try:
        if problem is None:
            problem, left_out = unpack_problem(data["problem"], unpacker)
            if left_out:
                warnings.warn(
                    f"{source.name} was loaded without {'; '.join(left_out)}. "
                    "Pass the problem to rt.load_solution(path, problem=...) to have everything back.",
                    stacklevel=3,
                )
        else:
            check_fit(problem, data["problem"], source.name)
        phases = [unpacker.unpack(phase) for phase in data["phases"]]
        return Contents(problem, phases, unpacker.unpack(data["facts"]), _unpacked_settings(data["settings"], unpacker))
    except RobotrajError:
        raise
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{str(source)!r} is damaged: {error}. Save the solution again.") from error


def _packed_settings(settings: Settings | None, packer: Packer) -> Any:
    """Write settings; None where a solver or another of them, defined elsewhere, is not plain data."""
    try:
        return packer.pack(settings, "settings")
    except NotPlainData:
        return None


def _unpacked_settings(data: Any, unpacker: Unpacker) -> Settings | None:
    """Make settings again; None, with a warning, where a class of theirs is missing."""
    try:
        settings: Settings | None = unpacker.unpack(data)
    except NotPlainData as error:
        warnings.warn(f"The settings of the plan could not be read: {error}", stacklevel=4)
        return None
    return settings


def _existing(source: Path) -> Path:
    for candidate in (source, source.with_name(source.name + ".npz")):
        if candidate.is_file():
            return candidate
    raise InputError(f"There is no file {str(source)!r}; {ADVICE}")


def _arrays(source: Path) -> dict[str, np.ndarray]:
    """Read all entries of the file, after making sure that it is one of ours."""
    try:
        with np.load(source, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        about = json.loads(str(arrays["about"]))
        kind, number = about["format"], about["version"]
    except (OSError, EOFError, ValueError, TypeError, KeyError, AttributeError, zipfile.BadZipFile) as error:
        raise InputError(f"{str(source)!r} holds no robotraj solution; {ADVICE}") from error
    if kind != FORMAT:
        raise InputError(f"{str(source)!r} holds a {kind!r}, not a {FORMAT!r}; {ADVICE}")
    if number != VERSION:
        raise InputError(
            f"{str(source)!r} has version {number} of the file format, written by robotraj "
            f"{about.get('robotraj')}; this robotraj ({_own_version()}) reads version {VERSION}. "
            "Load it with that robotraj, or plan again."
        )
    return arrays


def _text(data: Any) -> np.ndarray:
    return np.array(json.dumps(data, allow_nan=False))


def _own_version() -> str:
    try:
        return version("robotraj")
    except PackageNotFoundError:
        return "from a checkout"
