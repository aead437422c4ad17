"""Calls of public functions and classes whose arguments do not fit name the valid ones."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial, wraps
from inspect import Parameter, isfunction, signature
from traceback import walk_tb
from typing import Any

import numpy as np

from robotraj._util.checks import unusable
from robotraj._util.errors import InputError, RobotrajError, unknown_name
from robotraj._util.names.elsewhere import elsewhere
from robotraj._util.names.kinds import misfit
from robotraj._util.names.near_words import near_names
from robotraj._util.printing import brief


class WrongArguments(InputError, TypeError):
    """A call has an argument that its function does not take, or lacks one that it needs."""


def guarded(function: Callable[..., Any], package: str = "") -> Callable[..., Any]:
    """Return a function that refuses arguments which do not fit, and otherwise calls the given one.

    Signature, documentation and annotations are those of the given function. A call that fits costs one more frame.
    A constructor also refuses text where its annotations state numbers, and lists where they state text: every value
    has a hash. All kinds are compared where a call fails, since what binds a value often knows a better remedy.

    Parameters
    ----------
    function : callable
    package : str
        Public package of the function, by which pickles refer to it; "" keeps the function's own module.
    """
    fields = _plain_fields(function) if function.__name__ == "__init__" else []

    @wraps(function)
    def call(*arguments: object, **keywords: object) -> object:
        try:
            found = function(*arguments, **keywords)
        except RobotrajError:
            raise
        except Exception as error:  # of Python, NumPy, CasADi or Pinocchio, whose cause may be an argument
            if isinstance(error, TypeError):
                try:
                    signature(function).bind(*arguments, **keywords)
                except TypeError as unfit:
                    raise _refusal(function, keywords, unfit, package) from None
                inner = _passed_on(error, keywords)
                if inner is not None:
                    raise _refusal(function, keywords, error, package, inner) from None
            _refuse_values(function, arguments, keywords, package)
            raise
        for place, name, kind, misfits in fields:
            if place < len(arguments) or name in keywords:
                value = arguments[place] if place < len(arguments) else keywords[name]
                if misfits(value) and not (kind == "str" and getattr(type(value), "__hash__", None)):
                    raise _another_kind(name, kind, value, function, package)
        if type(found) not in _returned:
            _guard_value(found)
        return found

    if package:
        call.__module__ = package
    return call


def guard(cls: type) -> None:
    """Guard the constructor and the public methods that a class of this project defines or inherits, in place."""
    if cls in _known:
        return
    _known.add(cls)
    if not _is_ours(cls) or issubclass(cls, BaseException):
        return
    for name, method in list(vars(cls).items()):
        if name != "__init__" and name.startswith("_"):
            continue
        if isfunction(method):
            method.__module__ = method.__module__ or cls.__module__  # constructors that Python writes have none
            setattr(cls, name, guarded(method))
        elif isinstance(method, classmethod | staticmethod):
            setattr(cls, name, type(method)(guarded(method.__func__)))
    for base in cls.__bases__:
        guard(base)


def _guard_value(value: object) -> None:
    """Guard the class of a value that a public call returns, and those of its fields or entries."""
    _returned.add(type(value))
    guard(type(value))
    fields = getattr(value, "__dict__", {}).values() if _is_ours(type(value)) else ()
    for part in list(value if isinstance(value, list | tuple) else fields):
        guard(type(part[0] if isinstance(part, list | tuple) and part else part))


def _is_ours(cls: type) -> bool:
    return cls.__module__.partition(".")[0] == __name__.partition(".")[0]


_UNEXPECTED = re.compile(r"(\w+)\(\) got an unexpected keyword argument '(\w+)'")
_known: set[type] = set()
_returned: set[type] = set()
"""Classes of values that a call returned; those of their fields are guarded too."""


def _passed_on(error: TypeError, given: dict[str, object]) -> Callable[..., Any] | None:
    """Return the function that refused a keyword which a function with ``**options`` passed on; None for other errors.

    Python's message names the function, which is a global of its caller's frame.
    """
    found = _UNEXPECTED.match(str(error))
    if found is None or found[2] not in given:
        return None
    known = [frame.f_globals.get(found[1]) for frame, _ in walk_tb(error.__traceback__)]
    return next((inner for inner in reversed(known) if callable(inner)), None)


def _refusal(
    function: Callable[..., Any],
    given: dict[str, object],
    error: TypeError,
    package: str,
    inner: Callable[..., Any] | None = None,
) -> WrongArguments:
    """Return the error of a call that does not fit: near names of a wrong keyword, or what is missing or too many.

    ``inner`` is a further function whose keywords are those of the call.
    """
    known = [each for each in signature(function).parameters.values() if each.name not in ("self", "cls")]
    name = _public(function, package)
    # The first parameter of a function that options are passed on to is what the outer one made.
    more = list(signature(inner).parameters.values())[1:] if inner is not None else []
    named = (Parameter.KEYWORD_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
    names = list(dict.fromkeys(each.name for each in (*known, *more) if each.kind in named))
    wrong = [each for each in given if each not in names]
    if wrong:
        other = "" if near_names(wrong[0], names) else elsewhere(wrong[0])
        return WrongArguments(str(unknown_name(f"argument of {name}", wrong[0], names, other)))
    call = ", ".join(map(_written, known))
    return WrongArguments(f"{name} is called as {name}({call}); this call is wrong: {error}.")


_KINDS = {"str": "text", "float": "a number", "numbers": "numbers"}
"""What a message calls the kinds of annotations that constructors compare at once."""
_SEVERAL = frozenset(
    {"Quaternion", "Sequence[float]", "Triple", "tuple[float,...]", "tuple[float,float]", "tuple[float,float,float]"}
)
"""Annotations of directions, places and other lists of numbers; what binds bounds and weights reads these itself."""

Field = tuple[int, str, str, Callable[[object], bool]]
"""Place, name and kind of a parameter, and a function that is true of values that are certainly not of that kind."""


def _plain_fields(function: Callable[..., Any]) -> list[Field]:
    """Return the parameters that take text or numbers; their annotations are texts."""
    code = function.__code__
    fields: list[Field] = []
    for i, name in enumerate(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]):
        stated = function.__annotations__.get(name)
        kinds = set(stated.replace(", ", ",").split(" | ")) if isinstance(stated, str) else set()
        optional = "None" in kinds
        kinds.discard("None")
        if kinds == {"str"}:
            fields.append((i, name, "str", partial(_no_text, optional)))
        elif kinds == {"float"}:
            fields.append((i, name, "float", partial(_no_number, optional)))
        elif kinds and kinds <= _SEVERAL | {"float"}:
            fields.append((i, name, "numbers", _holds_text))
    return fields


def _no_text(optional: bool, value: object) -> bool:
    return not (isinstance(value, str) or (optional and value is None))


def _no_number(optional: bool, value: object) -> bool:
    """Whether a value is certainly no number; symbols and arrays of one entry may stand for numbers."""
    return isinstance(value, str | bytes | dict | list | tuple | set) or (value is None and not optional)


def _holds_text(value: object) -> bool:
    """Whether text stands where numbers are due: alone, in a list or array, or as a value of a mapping."""
    if isinstance(value, dict):
        value = list(value.values())
    elif isinstance(value, np.ndarray):
        value = value.ravel().tolist() if value.dtype.kind in "OSU" else ()
    return isinstance(value, str | bytes) or (isinstance(value, list | tuple) and any(map(_holds_text, value)))


def _another_kind(
    argument: str, kind: str, value: object, function: Callable[..., Any], package: str
) -> WrongArguments:
    call = _public(function, package)
    return WrongArguments(f"{argument}= of {call} must be {_KINDS[kind]}; got {brief(value)}.")


def _refuse_values(
    function: Callable[..., Any], arguments: tuple[object, ...], keywords: dict[str, object], package: str
) -> None:
    """Raise an error where an argument is of a wrong kind, or holds what no number or text of a computer can take.

    This names the cause of an error that Python or NumPy raised in a call that fits.
    """
    given = signature(function).bind(*arguments, **keywords).arguments
    if wrong := misfit(function, _public(function, package), given):
        raise WrongArguments(wrong)
    for argument, value in given.items():
        wrong = unusable(value)
        if wrong:
            raise InputError(f"{argument}= of {_public(function, package)} holds {wrong}")


def _public(function: Callable[..., Any], package: str) -> str:
    """Return the name by which users call a function; a class for its constructor."""
    name = function.__qualname__.removesuffix(".__init__")
    return f"rt{package.removeprefix('robotraj')}.{name}" if package else name


def _written(parameter: Parameter) -> str:
    """Write a parameter without its type: ``name``, ``name=...`` where it has a default or is given by name alone."""
    star: dict[object, str] = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}
    by_name = parameter.kind is Parameter.KEYWORD_ONLY or parameter.default is not Parameter.empty
    return f"{star.get(parameter.kind, '')}{parameter.name}{'=...' if by_name else ''}"
