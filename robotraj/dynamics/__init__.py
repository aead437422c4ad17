"""Dynamics as semi-explicit DAEs: rigid bodies with contacts, ground and design parameters, and user-defined systems.

Start with ``dae.py``. The room may import ``robot`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
