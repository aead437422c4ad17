"""The names that a package offers, imported on first use; their calls refuse wrong arguments by name."""

from __future__ import annotations

import copyreg
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from types import FunctionType, ModuleType

import lazy_loader

from robotraj._util.errors import NoSuchValue, unknown_name
from robotraj._util.names.keywords import guard, guarded
from robotraj._util.names.near_words import near_names
from robotraj._util.system.forks import unforked
from robotraj._util.system.interrupts import undisturbed

ALIKE = 0.85
"""Least ratio of equal letters of a name in another package that a message names."""

_guarded: dict[tuple[FunctionType, str], object] = {}
"""Public functions; one of two packages has two, so that messages name it as it was called."""


def attach_stub(package: str, file: str) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package, from the ``.pyi`` file beside its ``file``.

    Names are imported on first use, while no other thread forks and Ctrl-C waits. A function is returned as a public
    one of this package: pickles refer to it by that name.
    """
    imported, directory, names = lazy_loader.attach_stub(package, file)
    kind = type(sys.modules.get(package))
    if issubclass(kind, ModuleType) and kind is not ModuleType:
        # A function that reads a name of this package travels with it, but only plain modules travel by name.
        copyreg.pickle(kind, _by_name)

    def attribute(name: str) -> object:
        with unforked(), undisturbed():
            try:
                found: object = imported(name)
            except AttributeError:
                # Names with an underscore are protocols of Python and its libraries, as for ``no_attribute``.
                if name.startswith("_"):
                    raise
                message = _in_rooms(package, name, names, imported)
                raise NoSuchValue(message or str(unknown_name(f"name in {package}", name, names))) from None
        if isinstance(found, type):
            guard(found)
        elif isinstance(found, FunctionType):
            if (found, package) not in _guarded:
                _guarded[found, package] = guarded(found, package)
            found = _guarded[found, package]
            if name in vars(sys.modules[package]):
                setattr(sys.modules[package], name, found)
        return found

    return attribute, directory, names


def _in_rooms(package: str, name: str, names: list[str], imported: Callable[[str], object]) -> str:
    """Return a message with the names of that meaning in the packages of the top level; empty where there are none."""
    # Python looks for modules as attributes of their package first.
    if "." in package or find_spec(f"{package}.{name}") is not None:
        return ""
    rooms = [(each, imported(each)) for each in names if each.islower()]
    found = [
        f"rt.{room}.{near}"
        for room, module in rooms
        if isinstance(module, ModuleType)
        for near in near_names(name, getattr(module, "__all__", ()), ALIKE)
        if near[0].isupper() == name[0].isupper() and near not in names
    ]
    return f"There is no name in {package} named {name!r}. Did you mean {' or '.join(found)}?" if found else ""


def _by_name(module: ModuleType) -> tuple[Callable[[str], ModuleType], tuple[str]]:
    return import_module, (module.__name__,)
