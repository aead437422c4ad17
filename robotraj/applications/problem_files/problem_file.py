"""A problem from a file, with the options of its plan and the files that it writes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.planning.plan import plan
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import PlanOptions
    from robotraj.replay_page.options import ReplayOptions
    from robotraj.witness.validation import ValidationOptions


@dataclass(frozen=True, eq=False)
class ProblemFile(OneLine):
    """What ``rt.load_problem`` read.

    Attributes
    ----------
    path : Path
        The file, absolute.
    problem : Problem
    options : mapping
        Options of ``rt.plan``: the table ``[plan]``.
    validation, replay : mapping
        Options of ``rt.validate`` and ``rt.replay``: the tables ``[validate]`` and ``[replay]``.
    output : mapping of str to Path
        Files to be written, ``"html"``, ``"save"`` and ``"plot"``: the table ``[output]``.
    """

    path: Path
    problem: Problem
    options: PlanOptions
    validation: ValidationOptions
    replay: ReplayOptions
    output: Mapping[str, Path]

    def plan(self, **options: Unpack[PlanOptions]) -> Solution:
        """Plan the motion, ``rt.plan(file.problem, **file.options)``; the options given here precede the file's."""
        merged: PlanOptions = {**self.options, **options}
        return plan(self.problem, **merged)

    def __str__(self) -> str:
        return str(self.problem)
