"""The classes and functions that a file may name, with what they take.

The classes are those of saved solutions, so one entry in ``robotraj.solution.storage.classes`` serves both. Guesses and
the functions of ``rt.gait`` are added here.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import is_dataclass

import robotraj.gait as gait
import robotraj.guess as guess
from robotraj._util.errors import unknown_name
from robotraj.applications.problem_files.lines import KeyPath, Misplaced
from robotraj.applications.problem_files.parameters import Accepted, Maker, parameters_of
from robotraj.guess.guess import Guess
from robotraj.solution.storage.classes import OF_PROBLEMS


def _functions(result: str) -> dict[str, Maker]:
    """Return the functions of ``rt.gait`` that take a robot and return a value of one kind."""
    found = {name: getattr(gait, name) for name in gait.__all__ if inspect.isfunction(getattr(gait, name))}
    return {
        name: function
        for name, function in found.items()
        if str(inspect.signature(function).return_annotation) == result and "robot" in parameters_of(function)
    }


def _guesses() -> dict[str, Maker]:
    """Return initial guesses, and planners of their paths, that are made from plain data."""
    kinds = [Guess, *(getattr(guess, name) for name in guess.__all__)]
    made = [kind for kind in kinds if isinstance(kind, type) and is_dataclass(kind) and not inspect.isabstract(kind)]
    return {kind.__name__: kind for kind in made if "solution" not in parameters_of(kind)}


WRITTEN_OTHERWISE = ("Between", "Limits", "FollowPath")
"""Intervals are ``{ between = [lower, upper] }``, limits the options of ``robot.limits.with_``; paths are retimed."""

GAITS: Mapping[str, Maker] = {name: each for name, each in _functions("Problem").items() if name != "sequence"}
"""Functions of ``rt.gait`` that write a whole problem, for the table ``[gait]``."""

POSTURES: Mapping[str, Maker] = {**_functions("Array"), **_functions("Objective"), **_functions("Mirror")}
"""Functions of ``rt.gait`` that return a value for a problem; they get the robot of the phase."""

KINDS: Mapping[str, Maker] = {
    **{name: kind for name, kind in OF_PROBLEMS.items() if name not in WRITTEN_OTHERWISE},
    **_guesses(),
    **POSTURES,
}
"""Everything that ``type = "..."`` may name."""

EXPRESSIONS = ("Callable", "PointExpression", "EndExpression")


def kind_named(name: object, accepted: Accepted, place: KeyPath) -> Maker:
    """Return the class or function of a name.

    Raises
    ------
    Misplaced
        There is none; the message lists those that fit the place, the nearest first.
    """
    found = KINDS.get(name) if isinstance(name, str) else None
    if found is None:
        raise Misplaced(place, str(unknown_name("type", name, names_for(accepted) or KINDS)))
    return found


def names_for(accepted: Accepted) -> list[str]:
    """Names of the kinds that may stand in a place."""
    wanted = set(accepted.classes)
    fitting = [name for name, kind in KINDS.items() if isinstance(kind, type) and wanted & _bases(kind)]
    if accepted.has("ndarray", "Objective", "Mirror"):
        returned = {"Array": "ndarray"}
        for name, function in POSTURES.items():
            result = str(inspect.signature(function).return_annotation)
            fitting += [name] * accepted.has(returned.get(result, result))
    return fitting


def _bases(kind: type) -> set[str]:
    return {base.__name__ for base in kind.__mro__}


def only_kind(accepted: Accepted) -> Maker | None:
    """Return the class that a table without ``type`` is; None where several fit, or a table by names is meant."""
    if accepted.has("Mapping", "dict", "Any"):
        return None
    named = [KINDS[name] for name in accepted.classes if name in KINDS]
    return named[0] if len(named) == 1 else None
