"""What ``print(solution)`` shows: figures, meshes, proof and, where no motion was found, the reason and the remedy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from robotraj._util.printing import wrapped
from robotraj.dynamics.path_body import ACCELERATION
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.robot.known_robots.makers import limits_text
from robotraj.robot.limits import Limits
from robotraj.robot.size.reach import reaches
from robotraj.solution.claims.claim import Judgement
from robotraj.solution.claims.planned_claims import planned_claims
from robotraj.solution.conflict import Conflict, are_certain
from robotraj.solution.planned import Planned
from robotraj.solution.proof import Proof
from robotraj.solution.records import ContinuationRecord, MeshStep
from robotraj.solution.reserves.shares import REMEDIES, Share, used_up
from robotraj.solution.violation import Violation
from robotraj.solvers.status import Status

CONVERGED = (Status.SOLVED, Status.TOLERANCE_NOT_REACHED, Status.NOT_PROVED)
"""Statuses of motions that satisfy every row. Only for these the text lists violations between the knots."""
CHANGE_LIMITS = "Change one of these limits or the motion that conflicts with it."
CHANGE_LIMITS_OR_GUESS = "Change one of these limits, or start from another guess."
CHANGE_PATH = (
    "The path is given, and its timing does not wait for obstacles. Change the path, give the phase a longer "
    "duration=, or plan from start to end with rt.CollisionFree and without the path."
)


class Summarised(Planned, Protocol):
    """The attributes of a solution for its text, in addition to those for exports."""

    @property
    def seconds(self) -> float:
        """Total time [s]."""

    @property
    def error(self) -> float:
        """Largest relative error of an interval."""

    @property
    def refinement(self) -> Sequence[MeshStep]:
        """The meshes, in order."""

    @property
    def continuation(self) -> Sequence[ContinuationRecord]:
        """The continuation steps, in order."""

    @property
    def proof(self) -> Proof | None:
        """Measures between the collocation points."""

    @property
    def shares(self) -> Sequence[Share]:
        """Shares of cone, sole, torque and speed."""

    @property
    def interval_violations(self) -> Sequence[Violation]:
        """Rows on states that are violated between collocation points."""

    @property
    def control_interval_violations(self) -> Sequence[Violation]:
        """Bounds of controls that are exceeded there."""

    @property
    def conflicts(self) -> Sequence[Conflict]:
        """Bounds that exclude motions."""

    def violations(self, top: int = 3) -> Sequence[Violation]:
        """List the worst violations."""

    def in_phase(self, entry: Conflict | Violation) -> str:
        """Write an entry, with its phase where there are several."""


SMOOTH_PATH = (
    "Third derivatives of the path jump, and limits of jerk or torque rate hold on both sides of each jump. Give "
    "rt.retime a deviation=, for example 1e-3, within which a smooth path replaces it."
)
GRAVITY, IMPLAUSIBLE = 9.81, 10.0
"""Acceleration of gravity [m/s^2], and the multiple of it from which the acceleration of a link's masses is doubted."""
AT_BOUND, INSTANT = 1e-3, 1e-6
"""Relative distance of a duration from its least one that counts as none, and a duration of no motion [s]."""
JUMP = 1e-3
"""Least jump of a third derivative that counts, relative to the largest one."""


def summary(solution: Summarised) -> str:
    """Return the text of a solution in lines of at most 80 columns."""
    converged = solution.status in CONVERGED
    lines = [
        f"{solution.status.value}: objective {solution.objective:.8g}, duration {solution.duration:.6g} s, "
        f"{solution.iterations} iterations, {solution.seconds:.3g} s of processor time"
    ]
    lines += [
        f"  {step.name}: {step.status.value}, objective {step.objective:.8g}, "
        f"{step.iterations} iterations, {step.seconds:.3g} s"
        for step in solution.continuation
    ]
    lines += [
        f"  mesh {i}: {step.intervals} intervals, {step.points} points, error {step.error:.2e}, "
        f"objective {step.objective:.10g}, {step.iterations} iterations, {step.seconds:.3g} s"
        for i, step in enumerate(solution.refinement, 1)
    ]
    if solution.proof is not None:
        lines += str(solution.proof).splitlines()
    elif converged and not solution.refinement and (error := solution.error) is not None:
        lines.append(f"error between knots {error:.1e}; nothing was proved (plan with tolerance=, or without mesh=)")
    if converged and solution.shares:
        lines.append("uses " + ", ".join(map(str, solution.shares)))
    if solution.proof is not None and solution.success:
        later = [c.name for c in planned_claims(solution, solution.proof) if c.judgement is Judgement.NOT_JUDGED]
        lines += [f"not judged yet: {', '.join(later)} (rt.validate)"] if later else []
    if converged and solution.interval_violations:
        advice = "" if _is_kept_by_its_path(solution) else "; plan on a finer mesh"
        lines.append(f"between collocation points: {solution.interval_violations[0]}{advice}")
    if converged and solution.control_interval_violations:
        worst = solution.control_interval_violations[0]
        lines.append(
            f"between collocation points: {worst}; plan without mesh= and tolerance=, which proves limits there, or "
            "bound torques with interval_limits=rt.interval_limits.BernsteinBounds(controls=True)"
        )
    if converged:
        lines += _implausible_accelerations(solution) + _shortest_durations(solution)
    if not solution.success:
        lines += [f"in conflict: {solution.in_phase(conflict)}" for conflict in solution.conflicts[:5]]
        lines += [f"solver: {solution.message}"]
        lines += [f"  {solution.in_phase(violation)}" for violation in solution.violations(5)]
        lines += [f"try: {_remedy(solution)}"]
    # A line that is too long continues below with more indentation.
    return "\n".join(part for line in lines for part in wrapped(line.lstrip(), line[: len(line) - len(line.lstrip())]))


def _implausible_accelerations(solution: Summarised) -> list[str]:
    """Return a doubt on the joint whose masses accelerate most, beyond what motors and gears give; none below."""
    worst, doubt = IMPLAUSIBLE * GRAVITY, list[str]()
    for part in solution.phases:
        robot, limits = part.phase.robot, part.phase.limits
        if robot is None or robot.root != "fixed" or not isinstance(limits, Limits):
            continue
        times = np.sort(np.append(part.knots, 0.5 * (part.knots[1:] + part.knots[:-1])))
        accelerations = part.at(times).a
        far, bounds = reaches(robot.model), limits.largest("acceleration")
        for joint, unit, largest, limit in zip(
            robot.velocity_names, robot.units, np.abs(accelerations).max(axis=0), bounds, strict=True
        ):
            lever = 1.0 if unit == "m" else far[robot.model.getJointId(joint)]
            if joint in robot.actuated and not np.isfinite(limit) and largest * lever > worst:
                worst = largest * lever
                at = "" if unit == "m" else f" at {lever:.2g} m"
                doubt = [
                    f"doubt: {joint} accelerates with {largest:.4g} {unit}/s^2, "
                    f"{worst / GRAVITY:.0f} times gravity{at}, "
                    "without a limit of acceleration or rotors in the model. Give the maker's, "
                    f"rt.load(..., limits={limits_text(robot.name)}, rotors=...)"
                ]
    return doubt


def _shortest_durations(solution: Summarised) -> list[str]:
    """Return a doubt on the first phase of least time that ends at its least allowed duration; none elsewhere."""
    for part in solution.phases:
        phase, (least, longest) = part.phase, part.phase.duration_bounds
        terms = phase.objective.terms if phase.objective is not None else ()
        quick = any(weight > 0.0 and isinstance(term, Duration) for weight, term in terms)
        if quick and least < longest and part.duration <= max(least * (1.0 + AT_BOUND), INSTANT):
            why = (
                f"the least that duration= allows. Allow less for a faster motion, ({0.1 * least:g}, {longest:g})"
                if least > 0.0
                else "since nothing limits its speed. Give limits, or objective=rt.Duration() + 1e-3 * rt.Effort()"
            )
            return [f"doubt: phase {phase.name!r} takes {part.duration:.3g} s, {why}"]
    return []


def _remedy(solution: Summarised) -> str:
    if solution.conflicts:
        return CHANGE_LIMITS if are_certain(solution.conflicts) else CHANGE_LIMITS_OR_GUESS
    if _is_kept_by_its_path(solution):
        return CHANGE_PATH
    if any(_has_jumps_of_jerk(part.phase) for part in solution.phases):
        return SMOOTH_PATH
    used = [] if solution.status in CONVERGED else used_up(solution.shares)
    if solution.status is Status.TIME_LIMIT and used:
        eased = ", ".join(REMEDIES[share.kind] for share in used)
        return f"{solution.status.remedy} Or ease the motion by {eased}, or ask for less of it."
    return solution.status.remedy


def _has_jumps_of_jerk(phase: Phase) -> bool:
    """Whether a phase limits rates on a path whose third derivative jumps."""
    if phase.path is None or not any(v.name == f"rate.{ACCELERATION}" for v in phase.dae.controls):
        return False
    third = phase.path.curve.derivative().derivative().derivative()
    at, piece = third.breaks[1:-1], np.arange(len(third.breaks) - 2)
    if not piece.size:
        return False
    before, after = third(at, piece), third(at, piece + 1)
    return float(np.abs(after - before).max()) > JUMP * max(float(np.abs(values).max()) for values in third.values)


def _is_kept_by_its_path(solution: Summarised) -> bool:
    """Whether distances along a given path are not proved."""
    proof = solution.proof
    return proof is not None and proof.shortfall > 0.0 and any(part.phase.path is not None for part in solution.phases)
