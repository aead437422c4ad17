"""Problems that a user's ``make`` returns for a case; its errors name the case."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robotraj._util.errors import FailedExpression, InputError, RobotrajError
from robotraj._util.printing import brief
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem


def made(make: Callable[[Any], Any], case: object) -> Any:
    """Call a user's function of a case; an error names the case.

    Raises
    ------
    FailedExpression
        The function raised an error that is neither robotraj's nor a lack of memory.
    """
    try:
        return make(case)
    except (RobotrajError, MemoryError):
        raise
    except Exception as error:  # a user's function may raise any error
        text = " ".join(str(error).split()).rstrip(".")
        raise FailedExpression(
            f"make(case) failed: {type(error).__name__}: {text}. The case is {brief(case)}; correct make or the case."
        ) from error


def posed(make: Callable[[Any], Any], case: object) -> Problem:
    """Return the problem of a case.

    Raises
    ------
    InputError
        The function returned neither a problem nor a phase, or failed.
    """
    return as_problem(made(make, case))


def as_problem(given: object) -> Problem:
    """Return what a ``make`` returned as a problem.

    Raises
    ------
    InputError
        It is neither a problem nor a phase.
    """
    if isinstance(given, Phase):
        return Problem([given])
    if not isinstance(given, Problem):
        raise InputError(f"make(case) returned {brief(given)}; let it return an rt.Problem or an rt.Phase.")
    return given
