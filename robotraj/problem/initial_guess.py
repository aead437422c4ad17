"""The interface of guesses: states, algebraic variables and controls along every phase."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.problem.augmentation import Augmented
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem

Curve = Callable[[Array], Array]
"""From fractions of a phase (m,) to values (m, n)."""


@dataclass(frozen=True, eq=False)
class PhaseGuess:
    """A guess of one phase.

    Attributes
    ----------
    duration : float
        Duration [s].
    states, algebraic, controls : callable
        Functions from fractions of the phase (m,) to values (m, n), in the order of the phase's variables.
    parameters : mapping of str to float
        Every parameter of the phase by name.
    """

    duration: float
    states: Curve
    algebraic: Curve
    controls: Curve
    parameters: Mapping[str, float]


class InitialGuess(OneLine, ABC):
    """Initial values of all variables of a problem. A new kind of guess is one subclass that defines ``of``."""

    @abstractmethod
    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the guess of phase number ``index`` of the problem."""

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Return values of the unknowns of link number ``index`` by name, such as impulses; the others start at 0."""
        return {}

    def prepared(self, problem: Problem) -> InitialGuess:
        """Return the guess of this problem; computations that need all phases are done here. By default, ``self``."""
        return self


def zeros(size: int) -> Curve:
    """Return the curve that is zero everywhere, (m, size)."""
    return lambda s: np.zeros((len(s), size))


def with_copies(known: PhaseGuess, dae: Dynamics) -> PhaseGuess:
    """Return a guess whose added states equal the algebraic variables that they copy."""
    copies = dae.copies if isinstance(dae, Augmented) else {}
    if not copies:
        return known
    states, algebraic = [v.name for v in dae.states], [v.name for v in dae.algebraic]
    to = [states.index(name) for name in copies]
    of = [algebraic.index(name) for name in copies.values()]

    def completed(s: Array) -> Array:
        values = np.array(known.states(s))
        values[:, to] = known.algebraic(s)[:, of]
        return values

    return replace(known, states=completed)
