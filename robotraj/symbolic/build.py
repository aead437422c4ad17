"""Loading the compiled module."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import ModuleType

from robotraj._util.compiled_modules import check_versions, not_loaded


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
    casadi and pinocchio are imported above, so their libraries are in the process already and the module
    binds to those, wherever they are installed.
    """
    try:
        graphs = import_module("robotraj.symbolic._graphs")
    except ImportError as error:
        raise not_loaded("robotraj.symbolic._graphs", error) from error
    check_versions(graphs)
    return graphs
