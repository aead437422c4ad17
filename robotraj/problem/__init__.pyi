"""Problems as frozen values: phases, states, links, constraints, objectives and the rows that they impose.

Start with ``phase.py``. The room may import ``dynamics``, ``robot`` and what lies below.
"""

from . import constraints, links, objectives
from .augmentation import Augmented
from .phase import Phase
from .problem import Problem
from .state import State

__all__ = [
    "Augmented",
    "Phase",
    "Problem",
    "State",
    "constraints",
    "links",
    "objectives",
]
