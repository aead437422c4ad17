"""What a solver found: a trajectory that can be sampled, checked, saved, exported and plotted.

Start with ``solution.py``. The room may import ``solvers``, ``transcription`` and what lies below.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
