"""Initial guesses: arrays, straight lines, keyframes, inverse kinematics, earlier solutions, and walks of legs.

Start with ``base.py``. The room may import ``problem`` and what lies below.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
