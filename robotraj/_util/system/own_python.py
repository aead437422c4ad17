"""Python processes of this package, which import nothing from the working folder.

``python -m`` and ``python -c``, and so ``multiprocessing``, search the working folder first. A file ``shutil.py`` in it
would run. These processes are isolated (``-I``): folders in which the parent found the package come last.
Programs of other packages are looked up in the absolute entries of PATH alone, for the same reason.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

NEEDED = ("robotraj", "casadi", "numpy", "lazy_loader", "cloudpickle", "xacro", "yaml")
"""Packages that may lie outside the folders of an isolated interpreter, as below PYTHONPATH or a user's own site."""

_START = """
import json, signal, site, sys
signal.signal(signal.SIGINT, signal.SIG_IGN)
module, folders = json.loads(sys.argv.pop(1))
for folder in folders:
    site.addsitedir(folder)
from runpy import run_module
run_module(module, run_name="__main__", alter_sys=True)
"""


def command(module: str, *arguments: str) -> list[str]:
    """Return the command line of an isolated interpreter that runs a module of this package.

    The process ignores Ctrl-C: the process that started it decides when it ends.

    Parameters
    ----------
    module : str
        Such as ``"robotraj.native.engines"``.
    *arguments : str
        Its ``sys.argv[1:]``.
    """
    return [sys.executable, "-I", "-c", _START, json.dumps([module, _folders()]), *arguments]


def _folders() -> list[str]:
    """Folders in which this process finds the packages, absolute and without duplicates."""
    found: dict[str, None] = {}
    for name in NEEDED:
        spec = find_spec(name)
        if spec is not None and spec.origin is not None:
            file = Path(spec.origin).absolute()
            found[str(file.parents[1] if spec.submodule_search_locations else file.parent)] = None
    return list(found)


def absolute_entries() -> str:
    """Return PATH without entries that depend on the working folder; the system's own ones where none is left."""
    # An empty PATH would mean the working folder, too.
    return os.pathsep.join(filter(os.path.isabs, os.get_exec_path())) or os.defpath


@contextmanager
def without_working_folder() -> Iterator[None]:
    """Let this process look programs up in the absolute entries of PATH alone, as long as the context is open."""
    before = os.environ.get("PATH")
    os.environ["PATH"] = absolute_entries()
    try:
        yield
    finally:
        if before is None:
            del os.environ["PATH"]
        else:
            os.environ["PATH"] = before
