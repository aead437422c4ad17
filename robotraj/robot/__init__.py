"""A robot from its URDF: loading, limits, charts of its configuration space, and the robots known by name.

Start with ``robot.py``. The room may import ``_util``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
