"""Indirect methods for a direct solution: costates, necessary conditions, Pontryagin's equations.

Start with ``costate_trajectory.py``. The room may import ``solution``, ``transcription`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
