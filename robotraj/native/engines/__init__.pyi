"""How point functions are evaluated: CasADi's virtual machine, C compiled into the user's cache, or our own module."""

from .base import Engine, Mapped, StageMapped, VirtualMachine
from .cache import Cache
from .compiled import Compiled
from .compiler import CompilationFailed
from .native import Native

__all__ = [
    "Cache",
    "CompilationFailed",
    "Compiled",
    "Engine",
    "Mapped",
    "Native",
    "StageMapped",
    "VirtualMachine",
]
