"""The file: a NumPy ``.npz`` of plain arrays and one JSON text, never a pickle.

``about`` names the format, ``solution`` is the JSON, and every other entry is an array that the JSON
refers to, or a Pinocchio model as text. Plain NumPy reads it:
``np.load("swing.npz")["phases.0.trajectory.x.values"]``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import field, fields
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError, warn
from robotraj._util.paths import input_path, output_path
from robotraj._util.printing import OneLine
from robotraj._util.system.regular_files import near_files
from robotraj._util.system.whole_files import WholeFile
from robotraj._util.values import dataclass
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.settings import Settings
from robotraj.solution.storage.classes import layout, mismatch
from robotraj.solution.storage.entries import read_entries
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.plain_data import Damaged, Json, NotPlainData
from robotraj.solution.storage.problems import OtherProblem, check_fit, pack_problem, unpack_problem
from robotraj.solution.storage.unpacking import REFUSALS, Unpacker

FORMAT = "robotraj solution"
VERSION = 4
"""Version of the format, increased whenever older versions of robotraj cannot read new files."""

MESSAGE = 2000
"""Largest number of characters in the description of a damage."""
WORD = 60
"""Characters of a word of a file that an error message repeats."""

ADVICE = "give the path of a file that solution.save(path) wrote."
OTHERS = dict.fromkeys((".npy", ".pkl", ".pickle", ".mat", ".h5", ".hdf5"), "Let the name end in .npz.") | {
    ".csv": "solution.to_csv writes tables.",
    ".json": "solution.to_json writes JSON.",
    ".html": "rt.replay writes pages.",
    ".yaml": "solution.to_controller writes the files of controllers.",
    ".mcap": "solution.to_controller writes the files of controllers.",
}
"""Suffixes of other formats, each with what writes it."""


@dataclass(frozen=True, eq=False)
class Contents(OneLine):
    """What a file holds.

    Attributes
    ----------
    problem : Problem
    phases : sequence of PhaseSolution
    facts : mapping
        Plain data of the whole solution, by name.
    settings : Settings or None
        None also where they could not be written, such as those of a solver that is not plain data.
    about : mapping
        Format and version of a file that was read, and the version and classes of the robotraj that wrote it.
    """

    problem: Problem
    phases: Sequence[PhaseSolution]
    facts: Mapping[str, Json]
    settings: Settings | None
    about: Mapping[str, Json] = field(default_factory=dict)


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
    named = Path(path)
    if named.suffix.lower() in OTHERS:
        raise InputError(f"solution.save writes an .npz file; got {str(path)!r}. {OTHERS[named.suffix.lower()]}")
    whole = named.suffix == ".npz" or named.is_dir()
    target = output_path(named if whole else named.with_name(f"{named.name}.npz"), (), "the saved solution")
    packer = Packer()
    data = {
        "problem": pack_problem(contents.problem, packer),
        "phases": [packer.pack(_plain(phase), f"phases.{i}") for i, phase in enumerate(contents.phases)],
        "facts": packer.pack(dict(contents.facts), "facts"),
        "settings": _packed_settings(contents.settings, packer),
    }
    about = {"format": FORMAT, "version": VERSION, "robotraj": _own_version(), "classes": layout()}
    with WholeFile(target) as partial, partial.open("wb") as file:
        np.savez_compressed(file, about=_text(about), solution=_text(data), **packer.arrays)  # type: ignore[arg-type]
    return target


def read(path: str | os.PathLike[str], problem: Problem | None = None) -> Contents:
    """Read a file that ``write`` wrote.

    Parameters
    ----------
    path : path
        With or without ``.npz``.
    problem : Problem, optional
        Problem that replaces that of the file; its phases must have the same variables.

    Raises
    ------
    InputError
        No such file, a file of another kind or version, a damaged one, or one of another problem. A file that cannot
        be read and was written with other classes is not called damaged; the message names both versions.
    """
    source = _existing(input_path(path, "The saved solution"))
    arrays, about = _arrays(source)
    unpacker = Unpacker(arrays)
    try:
        data = _json(arrays, "solution")
        # Before a phase is made: a file may state thousands.
        _check_motions(data)
        if problem is None:
            problem, left_out = unpack_problem(data.get("problem"), unpacker)
            if left_out:
                warn(
                    f"{source.name} was loaded without {'; '.join(left_out)}. "
                    "Pass the problem to rt.load_solution(path, problem=...) to have everything back."
                )
        else:
            check_fit(problem, data.get("problem"), source.name)
        phases = [
            _phase(problem, i, unpacker.unpack(phase, f"phases.{i}")) for i, phase in enumerate(data.get("phases", ()))
        ]
        facts = unpacker.unpack(data.get("facts"), "facts")
        if not isinstance(facts, dict):
            raise Damaged("it holds no facts of the solution")
        return Contents(problem, phases, facts, _unpacked_settings(data.get("settings"), unpacker, about), about)
    except OtherProblem:
        raise
    except REFUSALS as error:
        kind = "" if isinstance(error, InputError) else f"{type(error).__name__} "
        raise unreadable(source, about, f"{kind}{error}") from error


def _check_motions(data: Mapping[str, Json]) -> None:
    """Compare the number of motions with that of phases, where the file states both."""
    stated, motions = data.get("problem"), data.get("phases")
    phases = stated.get("phases") if isinstance(stated, dict) else []
    if not isinstance(motions, list):
        raise Damaged("phases is no list of motions")
    if isinstance(phases, list) and phases and len(phases) != len(motions):
        raise Damaged(f"it holds {len(motions)} motions for {len(phases)} phases")


def unreadable(source: str | os.PathLike[str], about: Mapping[str, Json], fault: str) -> InputError:
    """Return the error for a file that is damaged, or that another robotraj wrote with other classes."""
    # A name in the file may be as long as the file.
    fault = fault[:MESSAGE].rstrip(".")
    if about.get("classes") == layout():
        return InputError(f"{os.fspath(source)!r} is damaged: {fault}. Save the solution again.")
    return InputError(f"{os.fspath(source)!r}: {fault}. {_writer(about)} Load it with that robotraj, or plan again.")


def _writer(about: Mapping[str, Json]) -> str:
    """Return a sentence on the robotraj that wrote a file, beside the running one."""
    return (
        f"Robotraj {str(about.get('robotraj'))[:MESSAGE]} wrote the file with other classes than those of the running "
        f"one ({_own_version()})."
    )


def _phase(problem: Problem, number: int, given: object) -> PhaseSolution:
    """Make the motion of a phase, whose polynomials have the columns of its variables and the knots of its mesh."""
    place = f"phases.{number}"
    if not isinstance(given, dict) or number >= len(problem.phases):
        raise Damaged(f"{place} is no motion of a phase of the problem")
    phase = problem.phases[number]
    wrong = mismatch(PhaseSolution, {"phase": phase, **given})
    if wrong is not None:
        raise Damaged(f"{place}: {wrong}")
    part = PhaseSolution(phase, **given)
    dae, trajectory = phase.dae, part.trajectory
    if tuple(trajectory.parameters) != tuple(phase.parameter_names):
        raise Damaged(f"{place}.trajectory has other parameters than its phase, in names or order")
    if not np.isfinite(np.array(list(trajectory.parameters.values()), dtype=float)).all():
        raise Damaged(f"{place}.trajectory has parameters that are not finite")
    for name, variables in (("x", dae.states), ("z", dae.algebraic), ("u", dae.controls)):
        curve: PiecewisePolynomial = getattr(trajectory, name)
        pieces = len(curve.breaks) - 1 if curve.breaks.ndim == 1 else -1
        if not pieces == len(curve.sites) == len(curve.values) == part.mesh.count:
            raise Damaged(f"{place}.trajectory.{name} has not one polynomial for each of {part.mesh.count} intervals")
        if not (np.isfinite(curve.breaks).all() and np.all(np.diff(curve.breaks) >= 0)):
            raise Damaged(f"{place}.trajectory.{name} has knots that do not ascend")
        for sites, values in zip(curve.sites, curve.values, strict=True):
            if np.ndim(sites) != 1 or np.shape(values) != (len(sites), len(variables)):
                raise Damaged(f"{place}.trajectory.{name} has values of another number than sites and variables")
    if not np.isfinite([trajectory.t0, trajectory.duration]).all():
        raise Damaged(f"{place}.trajectory starts or lasts no finite time")
    return part


def _plain(part: PhaseSolution) -> dict[str, object]:
    """Fields of a motion without its phase, which the problem holds."""
    return {entry.name: getattr(part, entry.name) for entry in fields(part) if entry.name != "phase"}


def _packed_settings(settings: Settings | None, packer: Packer) -> Json:
    """Write settings; None where a solver or another of them, defined elsewhere, is not plain data."""
    try:
        return packer.pack(settings, "settings")
    except NotPlainData:
        return None


def _unpacked_settings(data: object, unpacker: Unpacker, about: Mapping[str, Json]) -> Settings | None:
    """Make settings again; None, with a warning, where they hold what files do not set."""
    try:
        settings: Settings | None = unpacker.unpack(data, "settings")
    except (NotPlainData, Damaged) as error:
        other = "" if about.get("classes") == layout() else f". {_writer(about)}"
        warn(f"The settings of the plan could not be read: {error}{other}")
        return None
    return settings if isinstance(settings, Settings) else None


def _existing(source: Path) -> Path:
    for candidate in (source, Path(f"{source}.npz")):
        if os.path.isfile(candidate):
            return candidate
    raise InputError(f"There is no file {str(source)!r}; {ADVICE}{near_files(source)}")


def _arrays(source: Path) -> tuple[dict[str, NDArray[np.generic]], Mapping[str, Json]]:
    """Read all entries of the file, check that it is one of ours, and return them with what it is about."""
    try:
        arrays = read_entries(source)
        about = _json(arrays, "about")
        kind, number = about["format"], about["version"]
    except (OSError, *REFUSALS) as error:
        of_problem = str(source).endswith(".toml")
        advice = f"it is a problem file: robotraj plan {source} --save motion.npz solves it." if of_problem else ADVICE
        raise InputError(f"{str(source)!r} holds no robotraj solution: {error}; {advice}") from error
    if kind != FORMAT:
        raise InputError(f"{str(source)!r} holds a {kind!r:.{WORD}}, not a {FORMAT!r}; {ADVICE}")
    if number != VERSION:
        raise InputError(
            f"{str(source)!r} has version {number!s:.{WORD}} of the file format, written by robotraj "
            f"{about.get('robotraj')!s:.{WORD}}; this robotraj ({_own_version()}) reads version {VERSION}. "
            "Load it with that robotraj, or plan again."
        )
    return arrays, about


def _json(arrays: Mapping[str, NDArray[np.generic]], name: str) -> Json:
    """Read an entry of JSON; numbers that are not finite are no JSON."""
    if name not in arrays or arrays[name].dtype.kind != "U" or arrays[name].shape != ():
        raise Damaged(f"there is no text {name!r}")

    def refuse(constant: str) -> float:
        raise ValueError(f"{constant} in {name!r}")

    data = json.loads(str(arrays[name]), parse_constant=refuse)
    if not isinstance(data, dict):
        raise Damaged(f"{name!r} is no mapping")
    return data


def _text(data: Json) -> NDArray[np.generic]:
    return np.array(json.dumps(data, allow_nan=False))


def _own_version() -> str:
    try:
        return version("robotraj")
    except PackageNotFoundError:
        return "from a checkout"
