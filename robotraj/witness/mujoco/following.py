"""Simulation of a plan in MuJoCo, with feedback, over one or several periods."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError, require_solution
from robotraj.dynamics.applied_forces.external_force import Unheld
from robotraj.dynamics.terrain.flat import Flat
from robotraj.witness.mujoco.deviation import Fall
from robotraj.witness.mujoco.feedback import Feedback, LinearQuadratic
from robotraj.witness.mujoco.feet import SoftGround, feet_of, furnish
from robotraj.witness.mujoco.loop_closures import close, loops_of
from robotraj.witness.mujoco.model import mujoco_robot
from robotraj.witness.mujoco.reference_motion import ReferenceMotion
from robotraj.witness.mujoco.report import SecondOpinion
from robotraj.witness.mujoco.run import MujocoRun
from robotraj.witness.planned import limits_of
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.robustness.disturbances import Disturbances

if TYPE_CHECKING:
    import mujoco


def second_opinion(
    solution: SolutionLike,
    periods: int | None = None,
    feedback: Feedback | None = None,
    *,
    offset: ArrayLike = 0.0,
    ground: SoftGround | None = None,
    step: float = 5e-4,
    runs: int = 0,
    disturbances: Disturbances | None = None,
    bound: float = 0.1,
    seed: int = 0,
) -> SecondOpinion:
    """Simulate a plan in MuJoCo under tau = tau_plan - K(t) e, saturated at the effort limits.

    The MuJoCo model is built from the Pinocchio model, its feet from the contacts of the phases. MuJoCo's contacts are
    soft, and touchdowns happen when feet reach the ground: then the next phase begins, shifted to the places of these
    feet. Without contacts MuJoCo integrates by RK4, with contacts by implicit Euler steps. Loops are nearly rigid;
    position limits are MuJoCo's soft ones.

    Parameters
    ----------
    solution : Solution
        A plan of a robot.
    periods : int, optional
        Number of periods, each displaced, and mirrored if the plan is half a gait. Default: three for a plan closed by
        a link (``rt.Periodic``, ``rt.Mirror``, ``rt.Touchdown(repeat=...)``), else one.
    feedback : Feedback, optional
        ``LinearQuadratic()`` by default; ``JointFeedback()``, ``NoFeedback()``.
    offset : float or array_like (2 nv,)
        Disturbance of the first state of the plan: positions in tangent space, then velocities.
    ground : SoftGround, optional
        Stiffness and friction of the ground in MuJoCo.
    step : float
        Longest simulation step [s]; every interval of the plan is a whole number of steps.
    runs : int
        Number of further simulations with random ``disturbances`` under ``solution.gains``, for robots with a fixed
        root and without contacts; ``rt.witness.monte_carlo`` makes them, ``robustness`` of the result keeps them.
    disturbances, bound, seed
        See ``rt.witness.monte_carlo``.

    Returns
    -------
    SecondOpinion
        Prints as a report.

    Raises
    ------
    InputError
        MuJoCo is not installed, or the plan moves a System or has external forces or thrusters. Several periods are
        given for a plan that is not periodic, or ``runs`` for a plan with contacts or a moving root.
    """
    require_solution(solution, "rt.witness.second_opinion")
    course = ReferenceMotion(solution, periods)
    applied = [c.name for part in course.phases for c in part.phase.bound_contacts if isinstance(c, Unheld)]
    if applied:
        raise InputError(
            f"second_opinion() has no forces such as {applied[0]!r} (rt.ExternalForce, rt.Thruster); use rt.validate."
        )
    if not (is_finite(step) and step > 0):
        raise InputError(f"step = {step!r}; give a positive time [s].")
    if not (feedback is None or isinstance(feedback, Feedback)):
        raise InputError(
            f"feedback = {feedback!r}; give rt.witness.LinearQuadratic(), rt.witness.JointFeedback() or "
            f"rt.witness.NoFeedback(), or nothing."
        )
    if not (ground is None or isinstance(ground, SoftGround)):
        raise InputError(
            f"ground = {ground!r}; give rt.witness.SoftGround(...); its place is that of the contacts' grounds."
        )
    away = np.asarray(offset, dtype=float).ravel()
    if away.size not in (1, 2 * course.robot.model.nv):
        raise InputError(
            f"offset has {away.size} values; give one, or {2 * course.robot.model.nv}: positions, then speeds."
        )
    robustness = None
    if runs:
        from robotraj.witness.robustness.monte_carlo import monte_carlo

        robustness = monte_carlo(solution, runs, disturbances=disturbances, bound=bound, seed=seed)
    feet = feet_of(course)
    soft = ground if ground is not None else SoftGround()
    feedback = feedback if feedback is not None else LinearQuadratic()
    limits = limits_of(course.phases[0])

    loops = loops_of(course)

    def touching(spec: mujoco.MjSpec, bodies: Mapping[int, mujoco.MjsBody]) -> None:
        close(course, loops, 2.0 * step, spec, bodies)
        if feet:
            furnish(course, feet, soft, spec, bodies)

    robot = mujoco_robot(course.robot, limits, touching)
    below = next((ground for foot in feet for ground in foot.grounds if ground.below), Flat())
    run = MujocoRun(course, robot, feedback, feet, bool(feet or loops), Fall(course.robot, below))
    run.place(away)
    for passage in course.passages:
        if not run.through(passage, float(step)):
            break
    return replace(run.report(), robustness=robustness)
