"""From a problem to a checked solution: solve, refine, restart; continuation, many starts, sweeps.

Start with ``plan.py``. The room may import every room but ``cli``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
