"""Guesses that know robots: where a solver starts, as the motions people would sketch."""

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
