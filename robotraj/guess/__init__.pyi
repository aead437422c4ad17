"""Where a solver starts: straight lines, keyframes, inverse kinematics, earlier solutions, and walks of legs.

Start with ``guess.py``. The room may import ``problem`` and what lies below.
"""

from .default import default_guess
from .guess import FromSolution, Guess, StraightLine
from .inverse_kinematics import InverseKinematics
from .keyframes import Keyframes
from .legs.inverted_pendulum import InvertedPendulum
from .minimum_jerk import MinimumJerk
from .perturbed import Perturbed

__all__ = [
    "FromSolution",
    "Guess",
    "InverseKinematics",
    "InvertedPendulum",
    "Keyframes",
    "MinimumJerk",
    "Perturbed",
    "StraightLine",
    "default_guess",
]
