"""Every error robotraj raises on purpose.

Each message is one clear sentence that names what was wrong, lists the valid choices and says what to do.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


class RobotrajError(Exception):
    """Base of all errors raised by robotraj."""


class InputError(RobotrajError, ValueError):
    """The caller's input cannot hold; the message names the part that is wrong."""


class UnknownName(InputError):
    """A joint, frame, robot, state or parameter of that name does not exist."""


class BuildMismatch(RobotrajError, ImportError):
    """The compiled module is missing or was built against other versions than those installed."""


class NoSolutionFound(RobotrajError):
    """The solver stopped without a solution; ``solution`` keeps the last iterate.

    Attributes
    ----------
    solution : robotraj.Solution
        What the solver had when it stopped, with its status, remedy and violated rows.
    """

    def __init__(self, message: str, solution: Any) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.solution)


class ValidationFailed(RobotrajError):
    """A plan failed its forward-simulation proof; ``report`` holds the figures.

    Attributes
    ----------
    report : robotraj.witness.Report
        The report whose ``check`` raised.
    """

    def __init__(self, message: str, report: Any) -> None:
        super().__init__(message)
        self.report = report

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.report)


def unknown_name(kind: str, name: object, valid: Iterable[str], advice: str = "") -> UnknownName:
    """Build the error for a name that does not exist, with the nearest valid names first.

    Parameters
    ----------
    kind : str
        What the name should have been: ``"joint"``, ``"frame"``, ``"robot"`` ...
    name : object
        What was given.
    valid : iterable of str
        The names that exist.
    advice : str
        A closing sentence that says what to do.
    """
    from difflib import get_close_matches

    names = list(valid)
    near = get_close_matches(str(name), names, n=3, cutoff=0.5)
    shown = ", ".join(names[:30]) + (f", ... ({len(names)} in all)" if len(names) > 30 else "")
    guess = f" Did you mean {' or '.join(repr(n) for n in near)}?" if near else ""
    end = f" {advice}" if advice else ""
    return UnknownName(f"There is no {kind} named {name!r}.{guess} Valid names: {shown or 'none'}.{end}")
