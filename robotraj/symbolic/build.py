"""Loading the compiled module."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import ModuleType

from robotraj._util.system.compiled_modules import check_versions, not_loaded


@cache
def load_graphs() -> ModuleType:
    """Import the compiled module and check it.

    Returns
    -------
    module
        ``robotraj.symbolic._graphs``.

    Raises
    ------
    BuildMismatch
        When the module is missing, cannot be loaded, or was built against other versions.

    Notes
    -----
    ``compiled_modules`` imports casadi and pinocchio first. The compiled module binds to the libraries that they
    loaded, wherever they are installed.
    """
    try:
        graphs = import_module("robotraj.symbolic._graphs")
    except ImportError as error:
        raise not_loaded("robotraj.symbolic._graphs", error) from error
    check_versions(graphs)
    return graphs
