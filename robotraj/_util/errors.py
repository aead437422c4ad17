"""The errors of robotraj, and its warnings.

A message names the fault, its place, the valid choices and the remedy, in that order.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterable
from typing import TypeVar

from robotraj._util.printing import plain

Result = TypeVar("Result")


class RobotrajError(Exception):
    """Base of all errors raised by robotraj; names in its message, of files and joints, cannot control a terminal."""

    def __str__(self) -> str:
        return plain(super().__str__())


class InputError(RobotrajError, ValueError):
    """Invalid input of the caller; the message names the invalid part."""


class UnknownName(InputError):
    """A joint, frame, robot, state or parameter of that name does not exist."""


class NoSuchValue(InputError, AttributeError):
    """A value of this kind does not have the attribute, as a System has no joint positions."""


class NoEntries(InputError, TypeError):
    """A value has attributes, but no entries, so that brackets read nothing from it."""


class FailedExpression(InputError):
    """A user's function raised an error, which is this error's cause."""


class BuildMismatch(RobotrajError, ImportError):
    """The compiled module is missing or was built against other versions than those installed."""


class OutOfMemory(RobotrajError, MemoryError):
    """The operating system gave no more memory."""


class ValidationFailed(RobotrajError):
    """A plan failed its forward-simulation proof; ``report`` holds the figures.

    Attributes
    ----------
    report : robotraj.witness.Report
        The report whose ``check`` raised.
    """

    def __init__(self, message: str, report: object) -> None:
        super().__init__(message)
        self.report = report

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.report)


def require_solution(value: object, what: str) -> None:
    """Raise an error unless the value has the phases of a solution.

    Parameters
    ----------
    value : object
        What the caller passed.
    what : str
        The function or option that takes it, for messages.

    Raises
    ------
    InputError
        The value is not a solution.
    """
    parts = getattr(value, "phases", None)
    if parts is None or not all(hasattr(part, "phase") for part in parts):
        advice = " Its .best is one." if hasattr(type(value), "best") else ""
        if isinstance(value, str | os.PathLike):
            advice = f" rt.load_solution({os.fspath(value)!r}) reads a saved one."
        raise InputError(f"{what} takes a solution that rt.plan returned; got {type(value).__name__}.{advice}")


def unknown_name(kind: str, name: object, valid: Iterable[str], advice: str = "") -> UnknownName:
    """Build the error for a name that does not exist, with the names of like spelling or meaning first.

    Parameters
    ----------
    kind : str
        Kind of the name: ``"joint"``, ``"frame"``, ``"robot"`` ...
    name : object
        What was given.
    valid : iterable of str
        The names that exist.
    advice : str
        A closing sentence with the remedy.
    """
    from robotraj._util.names.near_words import near_names

    names = list(valid)
    near = near_names(str(name), names)
    shown = ", ".join(names[:30]) + (f", ... ({len(names)} in all)" if len(names) > 30 else "")
    guess = f" Did you mean {' or '.join(repr(n) for n in near)}?" if near else ""
    end = f" {advice}" if advice else ""
    return UnknownName(f"There is no {kind} named {name!r}.{guess} Valid names: {shown or 'none'}.{end}")


def no_attribute(value: object, name: str, advice: str = "") -> AttributeError:
    """Build the error for an attribute that a value does not have, with names of like spelling or meaning.

    Names that begin with an underscore are protocols of Python and its libraries, which look for them by trial; their
    error is a plain one.

    Parameters
    ----------
    value : object
    name : str
    advice : str
        A closing sentence with the remedy.
    """
    from robotraj._util.names.near_words import near_names

    what = f"{type(value).__name__!r} object has no attribute {name!r}"
    if name.startswith("_"):
        return AttributeError(what)
    # A value has many attributes, of which some are faintly like any name.
    near = near_names(name, (each for each in dir(value) if not each.startswith("_")), 0.75)
    guess = f" Did you mean {' or '.join(map(repr, near))}?" if near else ""
    return NoSuchValue(f"{what}.{guess}{advice and ' '}{advice}")


def no_entry(value: object, key: object) -> NoEntries:
    """Build the error for brackets behind a value whose parts are attributes; it names the attribute that is meant."""
    try:
        found = isinstance(key, str) and not key.startswith("_") and getattr(value, key) is not None
        advice = f"Write .{key}, an attribute." if found else "Its parts are attributes, which have names."
    except AttributeError as error:
        # What follows the first sentence is the advice; brackets lack the attribute just as a dot does.
        advice = str(error).partition(". ")[2]
    return NoEntries(f"{type(value).__name__!r} object has no entries, so [{key!r}] reads nothing. {advice}".rstrip())


def called(what: str, function: Callable[..., Result], *arguments: object) -> Result:
    """Call a user's function; an error names the function and the remedy.

    Parameters
    ----------
    what : str
        Label of the function for messages: ``"expression of constraint 'effort'"``.
    function : callable
    *arguments
        Points or symbols, the function's arguments.

    Raises
    ------
    FailedExpression
        The function raised an error that is not robotraj's.
    """
    try:
        return function(*arguments)
    except RobotrajError:
        raise
    except Exception as error:  # a user's function may raise any error
        raise FailedExpression(
            f"The {what} failed: {type(error).__name__}: {_one_line(error)} {_advice(error, arguments)}"
        ) from error


def _one_line(error: Exception) -> str:
    """Message of an error without CasADi's source lines and lists of prototypes."""
    from re import sub

    text = " ".join(str(error).partition("Possible prototypes")[0].split())
    text = sub(r"^\S+\.[ch]pp:\d+: (Assertion \".*?\" failed: )?", "", text)
    return text if text.endswith(".") else f"{text}."


def _advice(error: Exception, arguments: tuple[object, ...]) -> str:
    """Return the remedy for a failed function."""
    if "truth value" in str(error):
        return (
            "Symbols are neither true nor false. Replace `if` by casadi.if_else(condition, a, b), `max` and `min` by "
            "casadi.fmax and casadi.fmin, `and` and `or` by casadi.logic_and and casadi.logic_or."
        )
    if isinstance(error, AttributeError) and type(error.obj).__module__.startswith("robotraj."):
        return f"It has {', '.join(name for name in dir(error.obj) if not name.startswith('_'))}."
    count = len(arguments)
    given = f"It is called with {count} argument{'' if count == 1 else 's'}"
    inside = error.__traceback__ is not None and error.__traceback__.tb_next is not None
    points = all(_module(vars(sys.modules[type(each).__module__])) == _OURS for each in arguments)
    if isinstance(error, TypeError) and "argument" in str(error) and not inside and points and count in _CALLS:
        return f"{given}: {_CALLS[count]}."
    return f"{given} and reads CasADi symbols: write it with operators and CasADi's functions, of entries that exist."


_CALLS = {
    1: "write lambda point: ..., and read point.q, point.v, point.x['name'], point.t and others from it",
    2: "write lambda start, end: ..., two points, and read start.q, end.x['name'] and others from them",
}
"""How expressions of that many arguments are written."""
_OURS = __name__.partition(".")[0]
_PASSED_THROUGH = (_OURS, "contextlib")


def warn(message: str) -> None:
    """Issue a ``UserWarning`` at the innermost line outside of robotraj, however deep the caller stands in it.

    Examples
    --------
    >>> import pytest
    >>> with pytest.warns(UserWarning, match="too long"):
    ...     warn("The motion is too long.")
    """
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _module(frame.f_globals) in _PASSED_THROUGH:
        frame, level = frame.f_back, level + 1
    warnings.warn(plain(message), stacklevel=level)


def _module(names: dict[str, object]) -> str:
    return str(names.get("__name__", "")).partition(".")[0]
