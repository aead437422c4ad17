"""Obstacles: solid shapes in the world or on a frame of the robot, at rest or moving, for ``rt.CollisionFree``.

Start with ``base.py``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
