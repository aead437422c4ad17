"""Evaluators of point functions: CasADi's virtual machine, compiled C from the user's cache, or the compiled module."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
