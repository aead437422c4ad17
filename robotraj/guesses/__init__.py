"""Further guesses: minimum jerk, inverse kinematics, random variations of others."""

from robotraj.guesses.inverse_kinematics import InverseKinematics
from robotraj.guesses.minimum_jerk import MinimumJerk
from robotraj.guesses.perturbed import Perturbed

__all__ = ["InverseKinematics", "MinimumJerk", "Perturbed"]
