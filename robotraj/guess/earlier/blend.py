"""A blend of earlier solutions as a guess: their weighted mean at equal fractions of every phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import MET
from robotraj._util.values import dataclass, own
from robotraj.guess.from_solution import FromSolution, SolvedProblem
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.robot.root import QUATERNION


@dataclass(frozen=True, eq=False)
class Blend(InitialGuess):
    """The weighted mean of earlier solutions of one kind of problem, on any meshes.

    Durations, parameters, impulses and all variables at equal fractions of a phase are  sum_i w_i y_i. Root quaternions
    are first brought to one sign, and their mean is scaled to length 1. Where the equations are linear, and limits are
    active alike, the mean of optimal motions is optimal for the mean of their ends.

    Parameters
    ----------
    solutions : sequence of Solution
        With the same phases.
    weights : array (n,)
        Their weights, whose sum is 1.

    Raises
    ------
    InputError
        There are no solutions, or the weights are not one number a solution with the sum 1.
    """

    solutions: Sequence[SolvedProblem]
    weights: ArrayLike

    def __post_init__(self) -> None:
        weights = np.asarray(self.weights, dtype=float)
        if not len(self.solutions) or weights.shape != (len(self.solutions),):
            raise InputError(
                f"rt.guess.Blend takes one weight for each of one or more solutions, got {len(self.solutions)} "
                f"solutions and weights of the shape {weights.shape}."
            )
        if not abs(float(weights.sum()) - 1.0) <= MET:
            raise InputError(f"The sum of the weights of rt.guess.Blend is {float(weights.sum()):g}; it must be 1.")
        object.__setattr__(self, "weights", own(weights))

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Blend the phases of the same index."""
        parts = [FromSolution(each).of(phase, index) for each in self.solutions]
        floating = phase.state_robot is not None and phase.state_robot.root == "floating"
        return PhaseGuess(
            self._mean([part.duration for part in parts]),
            self._curve([part.states for part in parts], floating),
            self._curve([part.algebraic for part in parts]),
            self._curve([part.controls for part in parts]),
            {name: self._mean([part.parameters[name] for part in parts]) for name in parts[0].parameters},
        )

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Blend the unknowns of the links of the same index."""
        parts = [FromSolution(each).of_link(link, index) for each in self.solutions]
        return {name: self._mean([part.get(name, 0.0) for part in parts]) for name in parts[0]}

    def _mean(self, values: Sequence[float]) -> float:
        return float(np.dot(np.asarray(self.weights), values))

    def _curve(self, curves: Sequence[Curve], floating: bool = False) -> Curve:
        weights = np.asarray(self.weights)

        def curve(s: Array) -> Array:
            values = np.array([each(s) for each in curves])
            if not floating:
                return np.asarray(np.tensordot(weights, values, 1))
            turns = values[:, :, QUATERNION]
            turns *= np.where(np.sum(turns * turns[:1], axis=2, keepdims=True) < 0.0, -1.0, 1.0)
            blended = np.tensordot(weights, values, 1)
            blended[:, QUATERNION] /= np.linalg.norm(blended[:, QUATERNION], axis=1, keepdims=True)
            return np.asarray(blended)

        return curve
