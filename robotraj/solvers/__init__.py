"""Solvers of nonlinear programs, as values: one file each, the only ones that know its options.

Start with ``base.py``. The room may import ``transcription`` and what lies below.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
