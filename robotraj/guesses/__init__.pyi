"""Guesses that know robots: where a solver starts, as the motions people would sketch."""

from robotraj.guesses.default import default_guess
from robotraj.guesses.inverse_kinematics import InverseKinematics
from robotraj.guesses.inverted_pendulum import InvertedPendulum
from robotraj.guesses.keyframes import Keyframes
from robotraj.guesses.minimum_jerk import MinimumJerk
from robotraj.guesses.perturbed import Perturbed

__all__ = ["InverseKinematics", "InvertedPendulum", "Keyframes", "MinimumJerk", "Perturbed", "default_guess"]
