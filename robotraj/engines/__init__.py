"""How point functions are evaluated: CasADi's virtual machine, C compiled into the user's cache, or our own module."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
