"""Indirect methods for a direct solution: costates, necessary conditions, Pontryagin's equations.

Start with ``costate_trajectory.py``. The room may import ``solution``, ``transcription`` and what lies below.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
