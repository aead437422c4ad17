"""Feedback around a plan: its equations of motion linearised, and the time-varying gains that hold a robot on it.

Start reading in ``gains.py``. The folder imports robots, dynamics and numbers only, so that the plan can carry its gains
and the witness can simulate with them.
"""

from robotraj.solution.feedback.gains import Gains, PhaseGains, gains_of
from robotraj.solution.feedback.linearisation import Linearisation

__all__ = ["Gains", "Linearisation", "PhaseGains", "gains_of"]
