"""Validation of plans by independent code: plain Pinocchio and SciPy.

Start with ``validation.py``. The room may import ``solution``, ``problem`` and the rooms below them, but neither
``transcription`` nor ``solvers``. ``cost/finer_motions.py`` may: it looks for a motion that is better than the plan.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
