"""Feedback around a plan: its equations of motion linearised, and the time-varying gains that hold a robot on it.

Start with ``gains.py``. The folder imports robots and dynamics only, so that a plan carries its gains and the witness
simulates with them.
"""

from robotraj.solution.feedback.gains import Gains, PhaseGains, gains_of
from robotraj.solution.feedback.linearisation import Linearisation

__all__ = ["Gains", "Linearisation", "PhaseGains", "gains_of"]
