"""What a solver found: a trajectory that can be sampled, checked, saved, exported and plotted.

Start with ``solution.py``. The room may import ``solvers``, ``transcription`` and what lies below.
"""

from .export.controller_report import ControllerReport, controller_report
from .phase_solution import PhaseSolution
from .proof import Goals, Proof
from .records import MeshStep
from .reserves.shares import Share
from .sample import Sample
from .solution import Solution
from .storage.load import load_solution
from .violation import Violation

__all__ = [
    "ControllerReport",
    "Goals",
    "MeshStep",
    "PhaseSolution",
    "Proof",
    "Sample",
    "Share",
    "Solution",
    "Violation",
    "controller_report",
    "load_solution",
]
