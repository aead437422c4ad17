"""Where slacks of mechanical powers start that a guess leaves at 0."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.fixed_mesh.sizes.shares import is_kinked, shares_of
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits


@dataclass(frozen=True, eq=False)
class SlackPowers(InitialGuess):
    """A guess whose slacks have the power of the greatest effort at the guessed speed.

    A power of little weight leaves its slack nearly free, and the barrier of a solver moves it far from its bounds.
    From 0, where both bounds meet, a solver takes up to three times as many iterations.
    """

    given: InitialGuess

    def prepared(self, problem: Problem) -> InitialGuess:
        """Prepare the guess that was given."""
        return replace(self, given=self.given.prepared(problem))

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Values of the guess that was given."""
        return self.given.of_link(link, index)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Fill the slacks of joints with a limit of effort."""
        known, limits = self.given.of(phase, index), phase.limits
        names = [variable.name for variable in phase.dae.controls]
        if phase.state_robot is None or not isinstance(limits, Limits) or not any(map(_joint, names)):
            return known
        states = [variable.name for variable in phase.dae.states]
        efforts = dict(zip(limits.joints, limits.largest("effort"), strict=True))

        def controls(s: Array) -> Array:
            values, speeds = np.array(known.controls(s)), known.states(s)
            for i, joint in enumerate(map(_joint, names)):
                if joint and np.isfinite(efforts[joint]) and not values[:, i].any():
                    values[:, i] = efforts[joint] * np.abs(speeds[:, states.index(f"v.{joint}")]).mean()
            return values

        return replace(known, controls=controls)


def with_slack_powers(start: InitialGuess, problem: Problem) -> InitialGuess:
    """Return a start whose slacks of powers are not 0, where there are kinks that weigh little."""
    kinked = any(is_kinked(phase.dae) for phase in problem.phases)
    return SlackPowers(start) if kinked and not shares_of(problem).kinked else start


def _joint(name: str) -> str:
    """Return the joint of a slack power; empty for other controls."""
    return name.removeprefix("slack.tau.") if name.startswith("slack.tau.") else ""
