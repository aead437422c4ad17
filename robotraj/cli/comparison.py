"""Two solutions side by side: figures, errors, use of the limits, motion and settings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np

from robotraj._util.printing import as_call
from robotraj._util.values import dataclass
from robotraj.cli.conclude import number
from robotraj.robot.limits import Limits
from robotraj.solution.solution import Solution

SAMPLES = 1001
"""Times at which limits and motions are compared; those of the second motion are at equal fractions of its duration."""


@dataclass(frozen=True)
class Compared:
    """One measure of two solutions; None where a solution has none.

    Attributes
    ----------
    name, unit : str
    first, second : float, str or None
    """

    name: str
    unit: str
    first: float | str | None
    second: float | str | None

    @property
    def difference(self) -> float | None:
        """Second minus first; None for texts."""
        if isinstance(self.first, str) or isinstance(self.second, str) or self.first is None or self.second is None:
            return None
        return self.second - self.first

    @property
    def relative(self) -> float | None:
        """Difference relative to the first value; None where that is 0."""
        change, first = self.difference, self.first
        return None if change is None or not isinstance(first, float | int) or first == 0 else change / abs(first)

    @property
    def equal(self) -> bool:
        """Whether both are the same."""
        return self.first == self.second


MEASURES: Sequence[tuple[str, str, Callable[[Solution], float | str | None]]] = (
    ("status", "", lambda solution: solution.status.value),
    ("objective", "", lambda solution: number(solution.objective)),
    ("duration", "s", lambda solution: number(solution.duration)),
    ("error between knots", "", lambda solution: number(solution.error)),
    ("verdict", "", lambda solution: "nothing proved" if solution.proof is None else str(solution.proof).split(":")[0]),
    ("proof: error of the motion", "", lambda solution: _proof(solution, "error")),
    ("proof: excess over limits", "", lambda solution: _proof(solution, "excess")),
    ("proof: error of the integral", "", lambda solution: _proof(solution, "quadrature")),
    ("proof: objective to gain", "", lambda solution: _proof(solution, "unsettled")),
    ("violated rows", "", lambda solution: float(len(solution.violation_list))),
    ("worst row", "", lambda solution: str((*solution.violations(1), "none")[0])),
    ("intervals", "", lambda solution: float(sum(len(part.knots) - 1 for part in solution.phases))),
    ("iterations", "", lambda solution: float(solution.iterations)),
    ("seconds", "s", lambda solution: number(solution.seconds)),
)


def compared(first: Solution, second: Solution) -> list[Compared]:
    """Compare two solutions, which may be those of different problems."""
    rows = [Compared(name, unit, measure(first), measure(second)) for name, unit, measure in MEASURES]
    uses = [_use_of_limits(solution) for solution in (first, second)]
    rows += [Compared(f"use of {name} limits", "", uses[0].get(name), uses[1].get(name)) for name in uses[0] | uses[1]]
    names = dict.fromkeys([*first.parameters, *second.parameters])
    rows += [
        Compared(f"parameter {name}", "", number(first.parameters.get(name)), number(second.parameters.get(name)))
        for name in names
    ]
    return [*rows, *_motions(first, second), *_settings(first, second)]


def _proof(solution: Solution, name: str) -> float | None:
    return None if solution.proof is None else number(getattr(solution.proof, name))


def _use_of_limits(solution: Solution) -> dict[str, float]:
    """Return the largest share of the velocity and effort limits that the motion uses; infinite limits do not count."""
    shares: dict[str, float] = {}
    for part in solution.phases:
        limits, robot = part.phase.limits, part.phase.robot
        if robot is None or not isinstance(limits, Limits):
            continue
        sample = part.at(np.linspace(part.t0, part.t0 + part.duration, SAMPLES))
        driven = [robot.velocity_names.index(name) for name in robot.actuated]
        for name, values, joints in (("velocity", sample.v, slice(None)), ("effort", sample.tau, driven)):
            for sign, side in zip((-1.0, 1.0), limits.sides(name), strict=True):
                most = sign * side[joints]
                kept = np.isfinite(most) & (most > 0)
                if values is not None and kept.any():
                    share = float(np.max(sign * values[:, kept] / most[kept]))
                    shares[name] = max(shares.get(name, 0.0), share)
    return shares


def _motions(first: Solution, second: Solution) -> list[Compared]:
    """Return the largest distance of both motions at equal fractions of their durations, where a robot is the same."""
    robots = [part.phase.robot for solution in (first, second) for part in solution.phases]
    if any(robot is None or robot.velocity_names != robots[0].velocity_names for robot in robots):  # type: ignore[union-attr]
        return []
    samples = []
    for solution in (first, second):
        start = solution.phases[0].t0
        samples.append(solution.at(start + np.linspace(0.0, 1.0, SAMPLES) * solution.duration))
    pairs = [(name, unit, *(getattr(sample, name) for sample in samples)) for name, unit in _QUANTITIES.items()]
    return [
        Compared(f"largest distance of {name}", unit, 0.0, float(np.max(np.abs(a - b), initial=0.0)))
        for name, unit, a, b in pairs
        if a.shape == b.shape
    ]


_QUANTITIES = {"q": "rad, m", "v": "rad/s, m/s", "tau": "N m, N"}


def _settings(first: Solution, second: Solution) -> list[Compared]:
    """Return the settings, without their reasons."""
    if first.settings is None or second.settings is None:
        return []
    names = [entry.name for entry in fields(first.settings) if entry.name != "reasons"]
    return [
        Compared(f"setting {name}", "", *(as_call(getattr(each.settings, name)) for each in (first, second)))
        for name in names
    ]
