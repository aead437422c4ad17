"""Contacts: frames of the robot held on the ground or to each other. They are values, bound to a robot by ``bind``."""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
