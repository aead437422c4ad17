"""Limits between the collocation points of an interval: Bernstein bounds and constraint generation."""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
