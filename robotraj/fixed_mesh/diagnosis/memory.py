"""Memory of a plan: that of the process, a lower bound for a problem on a mesh, and the error where none is left."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from resource import RUSAGE_SELF, getrusage

import numpy as np

from robotraj._util.errors import OutOfMemory
from robotraj.problem.problem import Problem
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.shooting import SingleShooting

MATRICES = 2
"""Least number of dense blocks for each point: its derivatives and their factor."""
MB = 1e6


def resident() -> float:
    """Return the resident memory of this process [MB]; on macOS, where it is not known, the largest so far."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            pages = int(file.read().split()[1])
    except FileNotFoundError:
        return getrusage(RUSAGE_SELF).ru_maxrss / MB
    return pages * os.sysconf("SC_PAGE_SIZE") / MB


def is_shortage(error: BaseException | None) -> bool:
    """Whether an error, or one that it was raised from, is that no memory was left."""
    while error is not None:
        if isinstance(error, MemoryError) or "bad_alloc" in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


@contextmanager
def shortage_named() -> Iterator[None]:
    """Inside the block, errors of any library for want of memory become one ``OutOfMemory``."""
    try:
        yield
    except Exception as error:
        if not is_shortage(error):
            raise
        raise OutOfMemory(
            f"No memory was left; the process holds {resident():.0f} MB. Give fewer intervals, a looser tolerance or "
            "memory_limit=, or raise the limit of the system."
        ) from error


def least_memory(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> float:
    """Return a lower bound on the memory [MB] of the blocks of all intervals; solvers take several times as much."""
    meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
    total = 0.0
    for phase, own in zip(problem.phases, meshes, strict=True):
        states, others = len(phase.dae.states), len(phase.dae.algebraic) + len(phase.dae.controls)
        if any(isinstance(scheme, SingleShooting) for scheme in own.schemes):
            total += float(own.count * others) ** 2
        else:
            total += own.count * float(states + others) ** 2
    return MATRICES * np.dtype(float).itemsize * total / MB
