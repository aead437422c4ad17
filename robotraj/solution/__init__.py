"""What a solver found: a trajectory that can be sampled, checked, saved, exported and plotted.

Start with ``solution.py``. The room may import ``solvers``, ``transcription`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
