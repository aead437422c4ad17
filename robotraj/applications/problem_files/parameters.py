"""Parameters of classes and functions, and the kinds of values that their annotations accept."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import ModuleType

from robotraj._util.values import dataclass
from robotraj.solution.storage.classes import BASES, split

Maker = Callable[..., object]
"""A class or a function that makes a value from keyword arguments."""

REQUIRED = inspect.Parameter.empty
"""Default of parameters that have none."""

ANYTHING = "Any"
SEQUENCES = ("Sequence", "tuple", "list", "Iterable")
MAPPINGS = ("Mapping", "dict")
PATHS = ("Path", "PathLike")
LISTED = (*SEQUENCES, "ndarray", "ArrayLike", ANYTHING)

_DEPTH = 8
_KNOWN = BASES - {"object"}


@dataclass(frozen=True)
class Alternative:
    """One alternative of an annotation: its name, its arguments, and the module that they are written in."""

    name: str
    inside: tuple[str, ...]
    module: str


@dataclass(frozen=True)
class Accepted:
    """What an annotation accepts, aliases written out."""

    alternatives: tuple[Alternative, ...]

    def has(self, *names: str) -> bool:
        """Whether one of the alternatives has one of these names."""
        return any(each.name in names for each in self.alternatives)

    @property
    def classes(self) -> list[str]:
        """Names of the alternatives that are classes."""
        return [each.name for each in self.alternatives if each.name in _KNOWN]

    def entry(self, number: int) -> Accepted:
        """Return what an entry of a list may be."""
        found: list[Alternative] = []
        for each in self.alternatives:
            if each.name in SEQUENCES and each.inside:
                several = len(each.inside) == 1 or each.inside[-1] == "..."
                if several or number < len(each.inside):
                    found += _expanded(each.inside[0 if several else number], each.module)
            elif each.name in LISTED:
                found.append(Alternative(ANYTHING, (), each.module))
        return Accepted(tuple(found))

    def value(self) -> Accepted:
        """Return what a value of a mapping may be."""
        found: list[Alternative] = []
        for each in self.alternatives:
            if each.name in MAPPINGS and len(each.inside) == 2:
                found += _expanded(each.inside[1], each.module)
            elif each.name in (*MAPPINGS, ANYTHING):
                found.append(Alternative(ANYTHING, (), each.module))
        return Accepted(tuple(found))


@dataclass(frozen=True)
class Parameter:
    """A parameter of a class or function: name, annotation as it is written, and default."""

    name: str
    annotation: str
    default: object
    accepted: Accepted

    @property
    def required(self) -> bool:
        """Whether it has no default."""
        return self.default is REQUIRED


@cache
def parameters_of(maker: Maker) -> Mapping[str, Parameter]:
    """Return the parameters that a maker takes by keyword, in order; those of ``Unpack[...]`` are written out."""
    if is_dataclass(maker) and isinstance(maker, type) and vars(maker)["__dataclass_params__"].init:
        return {each.name: each for each in _fields(maker)}
    # Public functions are wrapped; names of their annotations are those of the module that defines them.
    function = inspect.unwrap(maker.__init__ if isinstance(maker, type) else maker)  # type: ignore[misc]
    found: dict[str, Parameter] = {}
    for name, each in inspect.signature(function).parameters.items():
        if name == "self" or each.kind is inspect.Parameter.VAR_POSITIONAL:
            continue
        text, module = str(each.annotation), function.__module__
        if each.kind is not inspect.Parameter.VAR_KEYWORD:
            found[name] = Parameter(name, text, each.default, accepted_by(text, module))
            continue
        options = getattr(sys.modules[module], text.partition("[")[2].rstrip("]"), None)
        for key, written in getattr(options, "__annotations__", {}).items():
            words = getattr(written, "__forward_arg__", str(written))
            found[key] = Parameter(key, words, None, accepted_by(words, options.__module__))
    return found


def _fields(kind: type) -> list[Parameter]:
    found = []
    for field in fields(kind):
        if not field.init:
            continue
        owner = next(base for base in kind.__mro__ if field.name in inspect.get_annotations(base))
        default = field.default
        if default is MISSING:
            default = REQUIRED if field.default_factory is MISSING else field.default_factory()
        text = str(field.type)
        found.append(Parameter(field.name, text, default, accepted_by(text, owner.__module__)))
    return found


def accepted_by(annotation: str, module: str) -> Accepted:
    """Return what an annotation accepts that stands in a module."""
    return Accepted(tuple(_expanded(annotation, module)))


def _expanded(annotation: str, module: str, depth: int = 0) -> list[Alternative]:
    """Write out the aliases of an annotation, each in the module that imports it."""
    found: list[Alternative] = []
    for part in split(annotation.strip().strip("\"'"), "|"):
        name, _, inside = part.strip("\"'").partition("[")
        owner, _, short = name.rpartition(".")
        if short in ("Optional", "Union"):
            arguments = split(inside.removesuffix("]"), ",") + ["None"] * (short == "Optional")
            found += [each for text in arguments for each in _expanded(text, module, depth + 1)]
            continue
        arguments = [text for text in split(inside.removesuffix("]"), ",") if text]
        # Aliases that are written out name the module of each class.
        alias = _alias(short, sys.modules.get(owner, sys.modules[module]))
        if alias is None or depth > _DEPTH:
            found.append(Alternative(short, tuple(arguments), module))
        else:
            found += _expanded(alias, module, depth + 1)
    return list(dict.fromkeys(found))


def _alias(name: str, module: ModuleType) -> str | None:
    """Return what an alias stands for; None for a name that stands for itself."""
    known = ("None", "bool", "int", "float", "str", "Callable", "PathLike", "Literal", *MAPPINGS, *LISTED)
    if name in known or name in _KNOWN:
        return None
    value = getattr(module, name, ANYTHING)
    if isinstance(value, str):
        return value
    return None if isinstance(value, type) and not getattr(value, "__args__", ()) else str(value)


WORDS = {
    "float": "a number", "int": "a whole number", "bool": "true or false", "str": "a text", "None": "'none'",
    "ndarray": "a list of numbers", "ArrayLike": "a list of numbers", "Path": "a path", "PathLike": "a path",
    "Between": "{ between = [lower, upper] }", "Solution": "the path of a saved solution",
    "Limits": "a table of limits", "Robot": "the name of a robot",
}  # fmt: skip
UNWRITTEN = (
    "Any", "Callable", "PointExpression", "EndExpression", "OwnLimits", "Quaternion", "Interval", "NearTurn", "object"
)  # fmt: skip
"""Alternatives that are not described: a file has no expressions, or other alternatives cover them."""


def described(accepted: Accepted) -> str:
    """Describe what is accepted in words, ``"a number, a list of numbers or 'none'"``."""
    texts = list(dict.fromkeys(_worded(each) for each in accepted.alternatives if each.name not in UNWRITTEN))
    if not texts:
        return "an expression that robotraj defines"
    return " or ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _worded(each: Alternative) -> str:
    if each.name in SEQUENCES:
        count = f"{len(each.inside)} " if each.name == "tuple" and "..." not in each.inside and each.inside else ""
        kinds = {_plural(Accepted(tuple(_expanded(text, each.module)))) for text in each.inside if text != "..."}
        return f"a list of {count}{kinds.pop() if len(kinds) == 1 else 'values'}"
    if each.name in MAPPINGS:
        return (
            f"a table of {_plural(Accepted(tuple(_expanded(each.inside[1], each.module))))}"
            if each.inside
            else "a table"
        )
    return WORDS.get(each.name, each.name)


def _plural(accepted: Accepted) -> str:
    """Name the entries of a list or table."""
    names = [each.name for each in accepted.alternatives if each.name not in UNWRITTEN]
    words = {"float": "numbers", "int": "whole numbers", "str": "texts", "Mapping": "tables"}
    if names and names[0] in SEQUENCES:
        return "lists of numbers" if "float" in str(accepted) else "lists"
    return words.get(names[0], names[0]) if names else "values"
