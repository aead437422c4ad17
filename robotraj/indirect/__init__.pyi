"""The indirect view of a direct solution: costates, necessary conditions, Pontryagin's equations.

Start with ``costate_trajectory.py``. The room may import ``solution``, ``transcription`` and what lies below.
"""

from .costate_trajectory import costates
from .junctions import cut_at_junctions
from .necessary_conditions import conditions
from .polished import PolishFailed
from .polishing import polish

__all__ = [
    "PolishFailed",
    "conditions",
    "costates",
    "cut_at_junctions",
    "polish",
]
