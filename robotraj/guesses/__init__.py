"""Guesses that know robots: where a solver starts, as the motions people would sketch."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
