"""The robot's collision geometry: spheres that enclose its shapes, and the pairs of links that may touch.

Start with ``robot_spheres.py``.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
