"""Loading the compiled module, and refusing one that does not fit what is installed."""

from __future__ import annotations

import ctypes
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import casadi

from robotraj.symbolic.build import check_versions, not_loaded


@cache
def load_native() -> ModuleType:
    """Import the compiled module and check it, once.

    Returns
    -------
    module
        ``robotraj.native._native``.

    Raises
    ------
    BuildMismatch
        When the module is missing, cannot be loaded, or was built against other versions.

    Notes
    -----
    casadi loads its own fatrop only when asked for that plugin. It is loaded here from casadi's wheel, so that the
    module binds to it wherever the wheel is installed. The wheel's BLASFEO is compiled for any x86 processor; the inner
    products of ``_kernels`` come before it, in the scope that its calls are bound in, and so does the recursion that
    solves fatrop's systems. Where casadi's plugin has run before, fatrop's calls are bound already and it does its own.
    """
    wheel = Path(casadi.__file__).parent
    try:
        ctypes.CDLL(str(_compiled().with_name("_kernels.so")), ctypes.RTLD_GLOBAL)
        for library in ("libblasfeo.so", "libfatrop.so"):
            ctypes.CDLL(str(wheel / library))
        native = import_module("robotraj.native._native")
    except (ImportError, OSError) as error:
        raise not_loaded("robotraj.native._native", error) from error
    check_versions(native)
    return native


def _compiled() -> Path:
    """Where the module is: beside this file or, where robotraj is installed in place, among the installed packages."""
    spec = find_spec("robotraj.native._native")
    if spec is None or spec.origin is None:
        raise ImportError("it is not there")
    return Path(spec.origin)
