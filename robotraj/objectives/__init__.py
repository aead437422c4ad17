"""Objectives: values that add up and scale."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
