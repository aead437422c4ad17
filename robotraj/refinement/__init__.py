"""Refinement: the error between knots, and the next mesh."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
