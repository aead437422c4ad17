"""How point functions are evaluated: CasADi's virtual machine, C compiled into the user's cache, or our own module."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
