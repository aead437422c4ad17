"""The robot's collision geometry: spheres that enclose its shapes, and the pairs of links that may touch.

Start with ``robot_spheres.py``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
