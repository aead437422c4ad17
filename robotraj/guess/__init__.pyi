"""Initial guesses: arrays, straight lines, keyframes, inverse kinematics, earlier solutions, and walks of legs.

Guesses subclass ``InitialGuess`` in ``problem/initial_guess.py``. Start with ``straight_line.py``.
The room may import ``problem`` and what lies below.
"""

from .default import default_guess
from .earlier.blend import Blend
from .from_solution import FromSolution
from .guess import InitialGuess
from .keyframes import Keyframes
from .legs.inverted_pendulum import InvertedPendulum
from .minimum_jerk import MinimumJerk
from .paths.geometric_path import GeometricPath
from .paths.planner import PathPlanner, RRTConnect
from .perturbed import Perturbed
from .reaching.inverse_kinematics import InverseKinematics
from .simulated import Simulated
from .straight_line import StraightLine

__all__ = [
    "Blend",
    "FromSolution",
    "GeometricPath",
    "InitialGuess",
    "InverseKinematics",
    "InvertedPendulum",
    "Keyframes",
    "MinimumJerk",
    "PathPlanner",
    "Perturbed",
    "RRTConnect",
    "Simulated",
    "StraightLine",
    "default_guess",
]
