"""Schemes as values: nodes, weights and the collocated interpolant."""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
