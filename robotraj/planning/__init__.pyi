"""From a problem to a checked solution: solve, measure, respond, restart and explain; continuation.

Start with ``plan.py``. The room may import every room but ``applications`` and ``cli``.
"""

from .compilation import Compilation, precompile
from .continuation import ContinuationStep, tightening
from .kinematic import Kinematic
from .plan import plan
from .settings import Restarts, Settings

__all__ = [
    "Compilation",
    "ContinuationStep",
    "Kinematic",
    "Restarts",
    "Settings",
    "plan",
    "precompile",
    "tightening",
]
