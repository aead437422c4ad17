"""Reader: values of a TOML file become those of robotraj's classes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

from robotraj._util.errors import unknown_name
from robotraj._util.values import dataclass
from robotraj.applications.problem_files.bounds import MOST_USES
from robotraj.applications.problem_files.kinds import EXPRESSIONS, KINDS, kind_named, names_for, only_kind
from robotraj.applications.problem_files.lines import Data, KeyPath, Misplaced
from robotraj.applications.problem_files.narrowing import narrowed
from robotraj.applications.problem_files.parameters import (
    ANYTHING,
    PATHS,
    SEQUENCES,
    Accepted,
    Maker,
    Parameter,
    described,
    parameters_of,
)
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.objectives.base import Objective
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.solution.storage.classes import fits, mismatch
from robotraj.solution.storage.load import load_solution

NONE = "none"
"""Text of Python's None, which TOML lacks."""


@dataclass(frozen=True, eq=False)
class Reader:
    """Turns the data of a file into values.

    Attributes
    ----------
    folder : Path
        Relative paths start here.
    defined : mapping
        Data of the table ``[define]``, which other values name.
    robots : mapping
        Robots by name.
    robot : Robot, optional
        The robot of the phase or gait that is read.
    within : tuple of str
        Names of ``[define]`` whose values are read.
    uses : list of int
        Number of values of ``[define]`` that were read so far, in its one entry.
    """

    folder: Path
    defined: Mapping[str, Data]
    robots: Mapping[str, Robot]
    robot: Robot | None = None
    within: tuple[str, ...] = ()
    uses: list[int] = field(default_factory=lambda: [0])

    def arguments(
        self, maker: Maker, data: Data, place: KeyPath, without: Sequence[str] = (), given: Sequence[str] = ()
    ) -> dict[str, Any]:
        """Read the arguments of a class or function.

        Parameters
        ----------
        maker : class or function
        data : dict
        place : KeyPath
        without : sequence of str
            Parameters that a file cannot set.
        given : sequence of str
            Parameters that the caller sets.

        Raises
        ------
        Misplaced
            A key is unknown or missing, or its value is none that the parameter takes.
        """
        known = {name: each for name, each in parameters_of(maker).items() if name not in (*without, *given)}
        name = "limits" if maker is Limits.with_ else maker.__name__
        if not isinstance(data, dict):
            raise Misplaced(place, f"{name} is a table of its parameters; got {data!r}.")
        for key in data:
            if key not in known and key != "type":
                weighted = isinstance(maker, type) and issubclass(maker, Objective)
                names = [*known, *(["weight"] if weighted else [])]
                raise Misplaced((*place, key), str(unknown_name(f"key of {name}", key, names)))
        missing = [key for key, each in known.items() if each.required and key not in data]
        if missing:
            raise Misplaced(place, f"{name} lacks {', '.join(map(repr, missing))}; its keys are {', '.join(known)}.")
        return {key: self._argument(known[key], entry, (*place, key)) for key, entry in data.items() if key != "type"}

    def _argument(self, parameter: Parameter, data: Data, place: KeyPath) -> object:
        value = self.value(data, parameter.accepted, place)
        if not fits(value, parameter.annotation):
            raise Misplaced(place, f"takes {described(parameter.accepted)}; got {data!r}.")
        return value

    def value(self, data: Data, accepted: Accepted, place: KeyPath) -> object:
        """Read one value."""
        if accepted.has("Objective") and isinstance(data, list):
            terms = (self.value(each, accepted, (*place, i)) for i, each in enumerate(data))
            return sum(cast("Iterator[Objective]", terms))
        if isinstance(data, dict):
            return self._table(data, accepted, place)
        if isinstance(data, list):
            return self._list(data, accepted, place)
        if isinstance(data, str):
            return self._text(data, accepted, place)
        return data

    def _list(self, data: list[Data], accepted: Accepted, place: KeyPath) -> object:
        entries = [self.value(each, accepted.entry(i), (*place, i)) for i, each in enumerate(data)]
        if accepted.has("ndarray", "ArrayLike") and not accepted.has(*SEQUENCES):
            return np.array(entries, dtype=float)
        as_tuple = accepted.has("tuple") and not accepted.has("Sequence", "list", ANYTHING)
        return tuple(entries) if as_tuple else entries

    def _text(self, text: str, accepted: Accepted, place: KeyPath) -> object:
        if text == NONE and accepted.has("None"):
            return None
        if text in self.robots and accepted.has("Robot"):
            return self.robots[text]
        if accepted.has("Solution") and text.endswith(".npz"):
            return self._made(place, text, lambda: load_solution(self.folder / text))
        if accepted.has(*PATHS) and os.path.exists(self.folder / text):
            return str(self.folder / text)
        if accepted.has("str", "Literal", ANYTHING, *PATHS) and not accepted.has(*EXPRESSIONS):
            return text
        if text in self.defined:
            return self._defined(text, accepted)
        names = names_for(accepted)
        if text not in names:
            advice = "Values of your own stand in [define]."
            near = str(unknown_name("value or type", text, [*self.defined, *names], advice)) if names else ""
            raise Misplaced(place, near or f"takes {described(accepted)}; got {text!r}.")
        kind = KINDS[text]
        if accepted.has("Callable") and any(each.required for each in parameters_of(kind).values()):
            return kind
        return self._of(kind, {}, place)

    def _defined(self, name: str, accepted: Accepted) -> object:
        """Read a value of ``[define]``, which may name others."""
        place: KeyPath = ("define", name)
        self.uses[0] += 1
        if name in self.within:
            raise Misplaced(place, f"is defined by itself: {' names '.join((*self.within, name))}.")
        if self.uses[0] > MOST_USES:
            raise Misplaced(place, f"is used with others more than {MOST_USES} times; write a smaller file.")
        return replace(self, within=(*self.within, name)).value(self.defined[name], accepted, place)

    def _table(self, data: dict[str, Data], accepted: Accepted, place: KeyPath) -> object:
        if set(data) == {"between"}:
            ends = data["between"]
            if not isinstance(ends, list) or len(ends) != 2:
                raise Misplaced((*place, "between"), f"takes [lower, upper]; got {ends!r}.")
            lower, upper = (None if end == NONE else end for end in ends)
            return self._made((*place, "between"), ends, lambda: between(lower, upper))
        if "type" in data:
            kind: Maker | None = kind_named(data["type"], accepted, (*place, "type"))
        elif accepted.has("Limits") and not accepted.has("Mapping"):
            return self._limits(data, place)
        else:
            kind = only_kind(accepted)
        if kind is None:
            if not accepted.has("Mapping", "dict", ANYTHING):
                names = names_for(accepted)
                advice = f"give type = one of {', '.join(names)}" if names else f"takes {described(accepted)}"
                raise Misplaced(place, f"{advice}; got the keys {', '.join(data) or 'of an empty table'}.")
            return {key: self.value(entry, accepted.value(), (*place, key)) for key, entry in data.items()}
        weighted = "weight" in data and "weight" not in parameters_of(kind)
        plain = {key: entry for key, entry in data.items() if not (weighted and key == "weight")}
        if weighted and not accepted.has("Objective"):
            raise Misplaced((*place, "weight"), "only objectives have a weight.")
        required = [name for name, each in parameters_of(kind).items() if each.required and name not in plain]
        if accepted.has("Callable") and len(required) == 1:
            # The contact of every foot: a function of the frame.
            return partial(kind, **self.arguments(kind, plain, place, given=required))
        value = self._of(kind, plain, place)
        if weighted:
            return self._made((*place, "weight"), data["weight"], lambda: data["weight"] * value)
        return value

    def _of(self, kind: Maker, data: dict[str, Data], place: KeyPath) -> object:
        """Make a value of a class or function of the table of kinds."""

        def make(data: Data) -> object:
            if not isinstance(kind, type):
                given = self.arguments(kind, data, place, given=("robot",))
                return kind(self._phase_robot(place), **given)
            given = self.arguments(kind, data, place)
            # A saved solution holds pairs of links instead of the path, a problem of the user names the file.
            checked = {name: each for name, each in given.items() if (kind, name) != (CollisionFree, "srdf")}
            wrong = (
                mismatch(kind, checked) if isinstance(kind, type) and hasattr(kind, "__dataclass_fields__") else None
            )
            if wrong is not None:
                raise Misplaced(place, f"{wrong}.")
            return kind(**given)

        return narrowed(make, data, place)

    def _limits(self, data: dict[str, Data], place: KeyPath) -> object:
        limits = self._phase_robot(place).limits
        return narrowed(lambda data: limits.with_(**self.arguments(Limits.with_, data, place)), data, place)

    def _phase_robot(self, place: KeyPath) -> Robot:
        if self.robot is None:
            raise Misplaced(place, "it needs a robot, and the phase has none.")
        return self.robot

    def _made(self, place: KeyPath, data: Data, make: Callable[[], object]) -> object:
        return narrowed(lambda _: make(), data, place)

    def for_robot(self, robot: Robot) -> Reader:
        """Return the reader for a phase of a robot."""
        return replace(self, robot=robot)
