"""Guesses that know robots: where a solver starts, as the motions people would sketch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
