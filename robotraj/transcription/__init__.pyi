"""Transcription: a problem on meshes becomes a nonlinear program with named rows.

Start with ``transcribe.py``. The room may import ``problem`` and what lies below.
"""

from . import interval_limits, refinement, schemes
from .nlp import Nlp
from .transcribe import transcribe

__all__ = [
    "Nlp",
    "interval_limits",
    "refinement",
    "schemes",
    "transcribe",
]
