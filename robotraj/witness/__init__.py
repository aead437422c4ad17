"""Validation of plans by independent code: plain Pinocchio and SciPy.

Start with ``validation.py``. The room may import ``solution``, ``problem`` and the rooms below them, but neither
``transcription`` nor ``solvers``.
"""

from robotraj.solution.reserves.shares import Share
from robotraj.solution.violation import Violation
from robotraj.witness.checks.energy import Energy
from robotraj.witness.checks.residual import Residual
from robotraj.witness.contacts.foot_order import FootOrder
from robotraj.witness.contacts.ground import SwingingFoot
from robotraj.witness.contacts.impact import Impact
from robotraj.witness.contacts.slip_and_friction import Holding
from robotraj.witness.figures import Tolerances
from robotraj.witness.mujoco import (
    Feedback,
    FootReport,
    JointFeedback,
    LinearQuadratic,
    NoFeedback,
    SecondOpinion,
    SoftGround,
    second_opinion,
)
from robotraj.witness.peak import Peak
from robotraj.witness.plants.plant import Landing
from robotraj.witness.point import NumericPoint
from robotraj.witness.report import Report
from robotraj.witness.robustness.disturbances import Disturbances
from robotraj.witness.robustness.followed import Followed, followed
from robotraj.witness.robustness.margin import DisturbanceMargin, disturbance_margin
from robotraj.witness.robustness.monte_carlo import MonteCarlo, monte_carlo
from robotraj.witness.simulation.drift import Drift, DriftRow
from robotraj.witness.simulation.simulate import Simulation, simulate
from robotraj.witness.simulation.tracking import TrackingResult, track
from robotraj.witness.validation import validate

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
    "Share",
    "Simulation",
    "SoftGround",
    "SwingingFoot",
    "Tolerances",
    "TrackingResult",
    "Violation",
    "disturbance_margin",
    "followed",
    "monte_carlo",
    "second_opinion",
    "simulate",
    "track",
    "validate",
]
