"""Contacts: frames of the robot held on the ground or to each other. They are values, bound to a robot by ``bind``."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
