"""Schemes are values: nodes, weights and the interpolant that was collocated."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
