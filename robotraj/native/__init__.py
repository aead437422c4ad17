"""Point functions evaluated in C++ at many points, and the stagewise program that the solver runs over them.

The inputs are numbers, sparse matrices and CasADi functions; problems and phases are unknown here. Start with
``engines/base.py``. The room may import ``_util``.

The C++ of ``src`` has rooms of its own, from the Python module down to what all of them use:

- ``bindings``: the Python module, one function a file
- ``interior_point``: the solver, with its ``problem`` (iterate, residuals, options) and its ``step`` (Newton's system)
- ``newton``: that system's matrices and the two ways to factorise it, ``riccati`` stage by stage and ``ldl`` as a whole
- ``program``: a stagewise nonlinear program and the chain rule over its ``point_functions``
- ``kernels``: the inner loops for each kind of processor, of ``tape``, ``rigid_body``, ``riccati``, ``sparse``
- ``collision``: motions of spheres among shapes, and the search for a free path
- ``parallel``: packs of numbers for vector registers, and threads
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
