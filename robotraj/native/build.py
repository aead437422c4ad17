"""Load the compiled module; a module built against other versions raises BuildMismatch."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import ModuleType

from robotraj._util.system.compiled_modules import check_versions, not_loaded


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
        The module is missing, cannot be loaded, or was built against other versions.
    """
    try:
        native = import_module("robotraj.native._native")
    except ImportError as error:
        raise not_loaded("robotraj.native._native", error) from error
    check_versions(native)
    return native
