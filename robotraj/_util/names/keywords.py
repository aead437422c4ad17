"""Calls of public functions and classes whose arguments do not fit name the valid ones."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from inspect import Parameter, isfunction, signature
from traceback import walk_tb
from typing import Any

from robotraj._util.checks import unusable
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import brief


class WrongArguments(InputError, TypeError):
    """A call has an argument that its function does not take, or lacks one that it needs."""


def guarded(function: Callable[..., Any], package: str = "") -> Callable[..., Any]:
    """Return a function that refuses arguments which do not fit, and otherwise calls the given one.

    Signature, documentation and annotations are those of the given function. A call that fits costs one more frame.
    A constructor also refuses lists and arrays where its annotations state text: a value must have a hash.

    Parameters
    ----------
    function : callable
    package : str
        Public package of the function, by which pickles refer to it; "" keeps the function's own module.
    """
    fields = _plain_fields(function) if function.__name__ == "__init__" else []
    texts = [(place, name) for place, name, kind in fields if kind == "str"]

    @wraps(function)
    def call(*arguments: object, **keywords: object) -> object:
        try:
            found = function(*arguments, **keywords)
        except TypeError as error:
            try:
                signature(function).bind(*arguments, **keywords)
            except TypeError as misfit:
                raise _refusal(function, keywords, misfit, package) from None
            inner = _passed_on(error, keywords)
            if inner is not None:
                raise _refusal(function, keywords, error, package, inner) from None
            _refuse_values(function, arguments, keywords, package)
            raise error
        except (ValueError, ArithmeticError, MemoryError) as error:
            if not isinstance(error, InputError):
                _refuse_values(function, arguments, keywords, package)
            raise error
        for place, name in texts:
            value = arguments[place] if place < len(arguments) else keywords.get(name)
            if getattr(type(value), "__hash__", None) is None:
                raise _another_kind(name, "str", value, function, package)
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
        if isfunction(method) and (name == "__init__" or not name.startswith("_")):
            setattr(cls, name, guarded(method))
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
    known = [each for each in signature(function).parameters.values() if each.name != "self"]
    name = _public(function, package)
    # The first parameter of a function that options are passed on to is what the outer one made.
    more = list(signature(inner).parameters.values())[1:] if inner is not None else []
    named = (Parameter.KEYWORD_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
    names = list(dict.fromkeys(each.name for each in (*known, *more) if each.kind in named))
    wrong = [each for each in given if each not in names]
    if wrong:
        return WrongArguments(str(unknown_name(f"argument of {name}", wrong[0], names)))
    call = ", ".join(map(_written, known))
    return WrongArguments(f"{name} is called as {name}({call}); this call is wrong: {error}.")


_KINDS = {"str": "text", "float": "a number", "int": "a whole number", "bool": "True or False"}
"""Annotations that are compared with the values given."""


def _plain_fields(function: Callable[..., Any]) -> list[tuple[int, str, str]]:
    """Return place, name and annotation of the parameters that take text, one number or a truth value."""
    code = function.__code__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    kinds = [(i, name, function.__annotations__.get(name)) for i, name in enumerate(names)]
    return [(i, name, kind) for i, name, kind in kinds if isinstance(kind, str) and kind in _KINDS]


def _misfits(kind: str, value: object) -> bool:
    """Whether a value is certainly not of a kind; symbols and arrays of one entry may stand for numbers."""
    if kind == "str":
        return not isinstance(value, str)
    return isinstance(value, str | bytes | dict | list | tuple | set | None)


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
    for _, argument, kind in _plain_fields(function) if isfunction(function) else ():
        if argument in given and _misfits(kind, given[argument]):
            raise _another_kind(argument, kind, given[argument], function, package)
    for argument, value in given.items():
        wrong = unusable(value)
        if wrong:
            raise InputError(f"{argument}= of {_public(function, package)} holds {wrong}")


def _public(function: Callable[..., Any], package: str) -> str:
    """Return the name by which users call a function; a class for its constructor."""
    name = function.__qualname__.removesuffix(".__init__")
    return f"rt{package.removeprefix('robotraj')}.{name}" if package else name


def _written(parameter: Parameter) -> str:
    """Write a parameter without its type: ``name``, ``name=...`` where it has a default."""
    star: dict[object, str] = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}
    return f"{star.get(parameter.kind, '')}{parameter.name}{'' if parameter.default is Parameter.empty else '=...'}"
