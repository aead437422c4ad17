"""How point functions are evaluated: by CasADi's virtual machine, or as compiled C from the user's cache."""

from robotraj.engines.base import Engine, Mapped, VirtualMachine
from robotraj.engines.cache import Cache
from robotraj.engines.compiled import Compiled
from robotraj.engines.compiler import CompilationFailed

__all__ = ["Cache", "CompilationFailed", "Compiled", "Engine", "Mapped", "VirtualMachine"]
