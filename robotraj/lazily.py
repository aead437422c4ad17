"""Packages whose names are imported when they are first asked for (PEP 562)."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any


class _Package(ModuleType):
    """A package whose functions are not hidden by modules of the same names."""

    def __setattr__(self, name: str, value: Any) -> None:
        # Python sets a submodule as an attribute of its package when it is first imported; rt.replay, rt.sweep and
        # constraints.between are functions.
        if not (isinstance(value, ModuleType) and name in self.__all__):
            super().__setattr__(name, value)


def lazily(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Make ``__getattr__``, ``__dir__`` and ``__all__`` of a package from its stub.

    The stub, ``__init__.pyi`` beside ``__init__.py``, lists every name once, for people, type checkers and this
    function: a plan does not wait for the contacts, the replay or the simulation that it does not use.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    """
    module = sys.modules[package]
    stub = Path(str(module.__file__)).with_suffix(".pyi")
    homes = _homes(stub.read_text(encoding="utf-8"))

    def find(name: str) -> Any:
        if name in homes:
            value = getattr(importlib.import_module(homes[name]), name)
            setattr(module, name, value)
            return value
        path = f"{package}.{name}"
        if not name.startswith("_"):
            try:
                return importlib.import_module(path)
            except ModuleNotFoundError as error:
                if error.name != path:
                    raise
        raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name, obj=module)

    def names() -> list[str]:
        return sorted({*vars(module), *homes})

    module.__class__ = _Package
    return find, names, sorted(homes)


def _homes(stub: str) -> dict[str, str]:
    """Find the module of every name in statements ``from module import name, name``, also over lines in parentheses.

    Python's parser would take longer than all the rest of this file.
    """
    homes: dict[str, str] = {}
    for statement in stub.split("\nfrom ")[1:]:
        module, _, listed = statement.partition(" import ")
        listed = listed[1:].partition(")")[0] if listed.startswith("(") else listed.partition("\n")[0]
        homes |= {name.strip(): module for name in listed.split(",") if name.strip()}
    return homes
