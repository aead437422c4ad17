"""Calls of public functions and classes whose arguments do not fit name the valid ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, isfunction, signature
from typing import Any

from robotraj._util.errors import InputError, unknown_name


class WrongArguments(InputError, TypeError):
    """A call has an argument that its function does not take, or lacks one that it needs."""


def guarded(function: Callable[..., Any], package: str = "") -> Callable[..., Any]:
    """Return a function that refuses arguments which do not fit, and otherwise calls the given one.

    Signature, documentation and annotations are those of the given function. A call that fits costs one more frame.

    Parameters
    ----------
    function : callable
    package : str
        Public package of the function, by which pickles refer to it; "" keeps the function's own module.
    """

    @wraps(function)
    def call(*arguments: object, **keywords: object) -> object:
        try:
            found = function(*arguments, **keywords)
        except TypeError as error:
            try:
                signature(function).bind(*arguments, **keywords)
            except TypeError as misfit:
                raise _refusal(function, keywords, misfit, package) from None
            raise error
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


_known: set[type] = set()
_returned: set[type] = set()
"""Classes of values that a call returned; those of their fields are guarded too."""


def _refusal(function: Callable[..., Any], given: dict[str, object], error: TypeError, package: str) -> WrongArguments:
    """Return the error of a call that does not fit: near names of a wrong keyword, or what is missing or too many."""
    known = [each for each in signature(function).parameters.values() if each.name != "self"]
    name = function.__qualname__.removesuffix(".__init__")
    name = f"rt{package.removeprefix('robotraj')}.{name}" if package else name
    names = [each.name for each in known if each.kind in (Parameter.KEYWORD_ONLY, Parameter.POSITIONAL_OR_KEYWORD)]
    wrong = [each for each in given if each not in names]
    if wrong:
        return WrongArguments(str(unknown_name(f"argument of {name}", wrong[0], names)))
    call = ", ".join(map(_written, known))
    return WrongArguments(f"{name} is called as {name}({call}); this call is wrong: {error}.")


def _written(parameter: Parameter) -> str:
    """Write a parameter without its type: ``name``, ``name=...`` where it has a default."""
    star: dict[object, str] = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}
    return f"{star.get(parameter.kind, '')}{parameter.name}{'' if parameter.default is Parameter.empty else '=...'}"
