"""Reference pages: one for the names at the top, and one for each namespace."""

from __future__ import annotations

import inspect
import re
import sys
from types import ModuleType

from mirror import GENERATED, write
from sphinx.application import Sphinx
from sphinx.config import Config

import robotraj as rt


def namespaces() -> dict[str, ModuleType]:
    """Return the public namespaces by their names."""
    return {name: getattr(rt, name) for name in rt.__all__ if isinstance(getattr(rt, name), ModuleType)}


def summary(label: str, module: ModuleType, names: list[str]) -> str:
    """Write a table of names, and below it what each of them is."""
    rows = "".join(f"   {name}\n" for name in names)
    text = f".. currentmodule:: {label}\n\n.. autosummary::\n   :nosignatures:\n\n{rows}\n"
    for name in names:
        value = getattr(module, name)
        kind = "class" if inspect.isclass(value) else "function" if callable(value) else "data"
        kind = "exception" if kind == "class" and issubclass(value, BaseException) else kind
        text += f".. auto{kind}:: {name}\n" + ("" if kind in ("function", "data") else "   :members:\n") + "\n"
    return text


def heading(text: str) -> str:
    """Write the heading of a page."""
    return f"{text}\n{'=' * len(text)}\n\n"


def purpose(module: ModuleType) -> str:
    """Return the first paragraph of a namespace's docstring, on one line."""
    return " ".join((inspect.getdoc(module) or "").partition("\n\n")[0].split())


def page(name: str, module: ModuleType, top: set[int]) -> str:
    """Write the page of a namespace; names that stand at the top have their page there."""
    own, elsewhere = [], []
    for entry in sorted(module.__all__):
        value = getattr(module, entry)
        if isinstance(value, ModuleType):
            continue
        (elsewhere if id(value) in top else own).append(entry)
    text = heading(f"rt.{name}") + f".. module:: robotraj.{name}\n\n"
    text += purpose(module) + "\n\n"
    if elsewhere:
        text += "At the top: " + ", ".join(f":obj:`rt.{entry} <robotraj.{entry}>`" for entry in elsewhere) + ".\n\n"
    return text + (summary(f"robotraj.{name}", module, own) if own else "")


def pages(app: Sphinx, config: Config) -> None:
    """Write the pages that autosummary reads."""
    spaces = namespaces()
    names = [name for name in rt.__all__ if name not in spaces]
    top = {id(getattr(rt, name)) for name in names}
    folder = GENERATED / "api"
    for old in folder.glob("*.rst"):
        if old.stem not in {"top", *spaces}:
            old.unlink()  # a namespace of an earlier build
    write(folder / "top.rst", heading("Names at the top") + ".. module:: robotraj\n\n" + summary("robotraj", rt, names))
    rows = "".join(
        f"| [rt.{name}](../generated/api/{name}.rst) | {purpose(spaces[name])} |\n" for name in sorted(spaces)
    )
    write(folder / "spaces.txt", "| namespace | what is in it |\n|---|---|\n" + rows)
    for name, module in spaces.items():
        write(folder / f"{name}.rst", page(name, module, top))


def plain(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    r"""Escape what reST reads as markup but a docstring means as it stands.

    Bars of absolute values, a star before a name as in ``f(*ends)``, and the plural of a literal.
    """
    for k, line in enumerate(lines):
        if not re.match(r"\s*(\| |\+[-=])", line):
            parts = re.split(r"(``.*?``|`[^`]+`)", line)
            parts[::2] = [re.sub(r"\||(?<![\w*])\*(?=\w)(?![^*]*\w\*)", r"\\\g<0>", part) for part in parts[::2]]
            parts[2::2] = [re.sub(r"^(?=\w)", r"\\ ", part) for part in parts[2::2]]
            lines[k] = "".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before autosummary looks for its tables."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", plain)
    # autodoc imports the module of a name; the namespaces at the top are rooms' modules under shorter names.
    sys.modules.update({f"robotraj.{name}": module for name, module in namespaces().items()})
    app.connect("config-inited", pages, priority=200)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
