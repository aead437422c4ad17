"""Limits between the collocation points of an interval: Bernstein bounds and constraint generation."""

from robotraj._util.forks import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
