"""robotraj: plan robot motions by direct collocation and prove them by simulation.

The public names are listed in ``__init__.pyi``, beside this file.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)


class _Package(ModuleType):
    """The package, whose functions are not hidden by modules of the same names."""

    def __setattr__(self, name: str, value: Any) -> None:
        # Python sets a submodule as an attribute of its package when it is first imported; rt.replay, rt.sweep and
        # rt.multistart are functions.
        if not (isinstance(value, ModuleType) and name in __all__):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
