"""Point functions evaluated in C++ at many points, and the stagewise program that the solver runs over them.

The inputs are numbers, sparse matrices and CasADi functions; problems and phases are unknown here. Start with
``engines/base.py``. The room may import ``_util``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import lazy_loader

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import CasadiBlock, Chain, Csr, Options, Outcome, PointBlock, Program, Stacked, Term
else:
    _native = load_native()
    CasadiBlock, PointBlock, Csr, Chain = _native.CasadiBlock, _native.PointBlock, _native.Csr, _native.Chain
    Options, Outcome = _native.Options, _native.Outcome
    Program, Stacked, Term = _native.Program, _native.Stacked, _native.Term

__getattr__, _, _ = lazy_loader.attach(__name__, submodules=["engines"])

__all__ = ["CasadiBlock", "Chain", "Csr", "Options", "Outcome", "PointBlock", "Program", "Stacked", "Term"]
