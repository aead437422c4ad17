"""Evaluators of point functions: CasADi's virtual machine, compiled C from the user's cache, or the compiled module."""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
