"""Validation of plans by independent code: plain Pinocchio and SciPy.

Start with ``validation.py``. The room may import ``solution``, ``problem`` and the rooms below them, but neither
``transcription`` nor ``solvers``.
"""

from .checks.energy import Energy
from .checks.residual import Residual
from .contacts.foot_order import FootOrder
from .contacts.ground import SwingingFoot
from .contacts.impact import Impact
from .contacts.slip_and_friction import Holding
from .figures import Tolerances
from .mujoco.feedback import Feedback, JointFeedback, LinearQuadratic, NoFeedback
from .mujoco.feet import SoftGround
from .mujoco.following import second_opinion
from .mujoco.report import FootReport, SecondOpinion
from .peak import Peak
from .plants.plant import Landing
from .point import NumericPoint
from .report import Report
from .robustness.disturbances import Disturbances
from .robustness.followed import Followed, followed
from .robustness.margin import DisturbanceMargin, disturbance_margin
from .robustness.monte_carlo import MonteCarlo, monte_carlo
from .simulation.drift import Drift, DriftRow
from .simulation.simulate import Simulation, simulate
from .simulation.tracking import TrackingResult, track
from .validation import validate

__all__ = [
    "DisturbanceMargin",
    "Disturbances",
    "Drift",
    "DriftRow",
    "Energy",
    "Feedback",
    "Followed",
    "FootOrder",
    "FootReport",
    "Holding",
    "Impact",
    "JointFeedback",
    "Landing",
    "LinearQuadratic",
    "MonteCarlo",
    "NoFeedback",
    "NumericPoint",
    "Peak",
    "Report",
    "Residual",
    "SecondOpinion",
    "Simulation",
    "SoftGround",
    "SwingingFoot",
    "Tolerances",
    "TrackingResult",
    "disturbance_margin",
    "followed",
    "monte_carlo",
    "second_opinion",
    "simulate",
    "track",
    "validate",
]
