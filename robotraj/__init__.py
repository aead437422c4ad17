"""robotraj: plan robot motions by direct collocation and prove them by simulation.

The public names are listed in ``__init__.pyi``, beside this file.
"""

from __future__ import annotations

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
