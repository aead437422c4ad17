"""Obstacles: solid shapes in the world or on a frame of the robot, at rest or moving, for ``rt.CollisionFree``.

Start with ``base.py``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
