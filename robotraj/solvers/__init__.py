"""Solvers of nonlinear programs, as values. Each is one file, which alone depends on the options of the solver.

Start with ``base.py``. The room may import ``transcription`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
