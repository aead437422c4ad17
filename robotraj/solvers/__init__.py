"""Solvers are values: one file each, the only ones that know its options."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
