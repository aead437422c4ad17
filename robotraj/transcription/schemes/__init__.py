"""Schemes are values: nodes, weights and the interpolant that was collocated."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
