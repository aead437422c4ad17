"""How point functions are evaluated: CasADi's virtual machine, C compiled into the user's cache, or our own module."""

from robotraj.engines.base import Engine, Mapped, StageMapped, VirtualMachine
from robotraj.engines.cache import Cache
from robotraj.engines.compiled import Compiled
from robotraj.engines.compiler import CompilationFailed
from robotraj.engines.native import Native

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
