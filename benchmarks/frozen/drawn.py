"""A drawn problem, and what its answer must contain."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

import robotraj as rt


@dataclass(frozen=True)
class Drawn:
    """A problem and the options of its plan.

    Attributes
    ----------
    problem : Phase, Problem or callable
        A callable builds a problem that may be refused.
    options : mapping of str to object
        Options of ``rt.plan``; none by default.
    names : tuple of str
        Words that the cause of an infeasible problem must contain; alternatives are separated by "|".
    """

    problem: rt.Phase | rt.Problem | Callable[[], rt.Phase | rt.Problem]
    options: Mapping[str, object] = field(default_factory=dict)
    names: tuple[str, ...] = ()


Draw = Callable[[np.random.Generator, int], Drawn]
"""From a generator and the number of the problem within its kind."""
