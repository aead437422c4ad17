"""From a problem to a checked solution: solve, refine, restart; continuation, many starts, sweeps.

Start with ``plan.py``. The room may import every room but ``cli``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
