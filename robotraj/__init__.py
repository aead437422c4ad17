"""robotraj: plan robot motions by direct collocation and prove them by simulation.

Public names are listed in ``__init__.pyi``, beside this file, for people, type checkers and the code below. Each is
imported when it is first asked for (PEP 562), so that a plan does not wait for what replays, simulates or polishes it.
"""

from __future__ import annotations

import ast
import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

_HOMES = {
    alias.name: str(node.module)
    for node in ast.parse(Path(__file__).with_suffix(".pyi").read_bytes()).body
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
}
"""The module that each public name comes from."""

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name, or a module of the package, when it is first asked for."""
    if name in _HOMES:
        value = getattr(importlib.import_module(_HOMES[name]), name)
        globals()[name] = value
        return value
    module = f"{__name__}.{name}"
    if not name.startswith("_"):
        try:
            return importlib.import_module(module)
        except ModuleNotFoundError as error:
            if error.name != module:
                raise
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name, obj=sys.modules[__name__])


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """The package, whose functions are not hidden by modules of the same names."""

    def __setattr__(self, name: str, value: Any) -> None:
        # Python sets a submodule as an attribute of its package when it is first imported; rt.replay, rt.sweep and
        # rt.multistart are functions.
        if not (isinstance(value, ModuleType) and name in _HOMES):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
