"""What is built on ``plan()``: paths and programs, many plans, studies, replanning, problems in files.

Start with ``many/sweep.py``. The room may import every room but ``cli``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
