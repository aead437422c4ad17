"""What a solver found: a trajectory that can be sampled, checked, saved, exported and plotted.

Start with ``solution.py``. The room may import ``solvers``, ``transcription`` and what lies below.
"""

from .export.controller_report import ControllerReport, controller_report
from .phase_solution import PhaseSolution
from .proof import Goals, Proof
from .records import MeshStep
from .sample import Sample
from .solution import Solution
from .storage.load import load_solution

__all__ = [
    "ControllerReport",
    "Goals",
    "MeshStep",
    "PhaseSolution",
    "Proof",
    "Sample",
    "Solution",
    "controller_report",
    "load_solution",
]
