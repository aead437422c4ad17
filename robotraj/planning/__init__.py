"""From a problem to a checked solution: solve, measure, respond, restart and explain; continuation.

Start with ``plan.py``. The room may import every room but ``applications`` and ``cli``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
