"""Whether a robot follows a plan under the witness's own feedback in MuJoCo, judged where it is installed."""

from __future__ import annotations

import importlib.util

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.witness.mujoco.following import second_opinion
from robotraj.witness.mujoco.report import SecondOpinion
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.simulation.drift import DriftRow

NEAR = 0.5
"""Default of the largest deviation of a joint from the plan [rad, m] with which the plan counts as followed."""


@dataclass(frozen=True)
class Followed(OneLine):
    """How a robot followed a plan in MuJoCo.

    Attributes
    ----------
    holds : bool or None
        Whether it completed all periods without a fall, with joints near the plan; None where this was not judged.
    reason : str
        Why it failed, or why it was not judged; empty where it holds.
    opinion : SecondOpinion or None
        The simulation, with deviation, slip and the share of time at an effort limit.
    """

    holds: bool | None
    reason: str = ""
    opinion: SecondOpinion | None = None

    def __str__(self) -> str:
        if self.holds is None:
            return f"followed: not judged, {self.reason}"
        if self.opinion is None or not self.holds:
            return f"followed: fails, {self.reason}"
        worst = self.opinion.deviation.worst
        return (
            f"followed: holds, {self.opinion.periods} periods, deviation at most {worst.largest:.2g} {worst.unit} "
            f"({worst.name}), at an effort limit {100 * self.opinion.saturated:.1f} % of the time"
        )


def followed(solution: SolutionLike, periods: int | None = None, near: float = NEAR) -> Followed:
    """Let MuJoCo's robot follow a plan under ``LinearQuadratic()``, on soft ground and with all limits of its motors.

    Parameters
    ----------
    solution : Solution
    periods : int, optional
        As of ``second_opinion``: three of a plan that repeats, else one.
    near : float
        Largest deviation of a joint from the plan [rad, m].

    Returns
    -------
    Followed
        Not judged where MuJoCo is not installed, the plan moves a System, or it cannot be linearised.
    """
    if importlib.util.find_spec("mujoco") is None:
        return Followed(None, "MuJoCo is not installed: pip install 'robotraj[mujoco]'")
    try:
        opinion = second_opinion(solution, periods)
    except InputError as error:
        return Followed(None, str(error))
    if opinion.completed:
        worst = worst_joint(opinion)
        if worst is None or worst.largest <= near:
            return Followed(True, "", opinion)
        where = f"{worst.name} deviates by {worst.largest:.2g} {worst.unit} at t = {worst.time:.4g} s"
        return Followed(False, f"{where}, {near:g} is allowed", opinion)
    fell = f"it falls at t = {opinion.fell:.4g} s" if opinion.fell is not None else ""
    return Followed(False, opinion.failure or fell, opinion)


def worst_joint(opinion: SecondOpinion) -> DriftRow | None:
    """Return the largest deviation of a joint's position from the plan; None for a single body."""
    joints = [row for row in opinion.deviation.rows if row.name.startswith("q.") and ".root_" not in row.name]
    return max(joints, key=lambda row: row.largest, default=None)
