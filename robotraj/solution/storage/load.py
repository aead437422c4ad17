"""``load_solution``: read a solution from a file."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.feedback.gains import Gains
from robotraj.solution.solution import Solution
from robotraj.solution.storage.archive import read, unreadable
from robotraj.solution.storage.classes import mismatch


def load_solution(path: str | Path, problem: Problem | Phase | None = None) -> Solution:
    """Read a solution that ``solution.save`` wrote.

    A file keeps no Python functions: equations of an ``rt.System``, expressions of ``PathConstraint``,
    ``Lagrange`` and ``Mayer``, height functions. A solution loaded without them can be sampled, plotted, exported
    and replayed; a warning names what is missing. A robot's planning model is in the file, its shapes are read
    from its URDF again.

    Parameters
    ----------
    path : path
        With or without ``.npz``.
    problem : Problem or Phase, optional
        The problem of the solution, which replaces that of the file.

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        There is no such file, or it is damaged or of another kind or version. Another version may have written it
        with other classes. Or the problem has other phases or variables.
    """
    if not isinstance(path, str | PathLike):
        raise InputError(f"rt.load_solution takes the path of a file; got {type(path).__name__}.")
    if not isinstance(problem, Problem | Phase | None):
        raise InputError(f"problem= must be the rt.Problem or rt.Phase that was solved; got {type(problem).__name__}.")
    contents = read(path, Problem([problem]) if isinstance(problem, Phase) else problem)
    facts = dict(contents.facts)
    gains = facts.pop("gains", None)
    given = {"problem": contents.problem, "phases": tuple(contents.phases), **facts, "settings": contents.settings}
    wrong = mismatch(Solution, given)
    if wrong is not None:
        raise unreadable(path, contents.about, f"facts: {wrong}")
    solution = Solution(**given)
    if gains is not None:
        try:
            solution.__dict__["gains"] = Gains.of(gains)
        except (KeyError, TypeError, ValueError) as error:
            raise unreadable(path, contents.about, f"facts.gains: {error}") from error
    return solution
