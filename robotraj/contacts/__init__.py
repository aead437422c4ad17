"""Contacts: what holds the robot, with which forces. Values, bound to a robot by ``bind``."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
