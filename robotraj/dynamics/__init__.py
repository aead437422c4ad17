"""Dynamics as semi-explicit DAEs: user systems and rigid bodies."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
