"""The second opinion: MuJoCo moves the robot under the planned torques and a feedback, period after period."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from robotraj.errors import InputError
from robotraj.terrain import Flat
from robotraj.witness.mujoco.course import Course, Passage
from robotraj.witness.mujoco.deviation import Fall, deviation_of
from robotraj.witness.mujoco.feedback import Feedback, LinearQuadratic
from robotraj.witness.mujoco.feet import Softness, feet_of, furnish
from robotraj.witness.mujoco.footfalls import Footfalls
from robotraj.witness.mujoco.model import MujocoRobot, mujoco_robot
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.mujoco.report import SecondOpinion
from robotraj.witness.peak import peaks
from robotraj.witness.protocols import Array, SolutionLike
from robotraj.witness.residual import TORQUE_UNITS
from robotraj.witness.simulation import Simulation

DIVERGED = 1e6
"""A velocity [rad/s, m/s] that no robot reaches: the simulation has blown up."""

GLANCE = 0.005
"""Every so often [s] the robot is looked at, whether it has fallen."""

IMPEDANCE_RATIO = 10.0
"""How much harder friction is than the normal direction: soft contacts creep, this makes it a tenth."""


def second_opinion(
    solution: SolutionLike,
    periods: int | None = None,
    feedback: Feedback | None = None,
    *,
    offset: Any = 0.0,
    softness: Softness | None = None,
    step: float = 5e-4,
) -> SecondOpinion:
    """Let MuJoCo follow a plan: tau = tau_plan - K(t) e, cut off at the effort limits.

    The robot is written out for MuJoCo from its Pinocchio model, its feet from the contacts of the phases. MuJoCo's
    contacts are soft and know nothing of the plan's schedule: feet land when they land. Without contacts it integrates
    by RK4, with them by its implicit Euler steps.

    Parameters
    ----------
    solution : Solution
        Of a robot.
    periods : int, optional
        How often a periodic plan is run through, each time displaced, and mirrored if it is half a gait. Default: three
        times if a link closes it (``rt.Periodic``, ``rt.Mirror``, ``rt.Touchdown(repeat=...)``), else once.
    feedback : Feedback, optional
        ``LinearQuadratic()`` by default; ``JointFeedback()``, ``NoFeedback()``.
    offset : float or array_like (2 nv,)
        Added to the plan's first state, a disturbance to recover from: positions in tangent space, then velocities.
    softness : Softness, optional
        Of the contacts.
    step : float
        Longest simulation step [s]; every interval of the plan is a whole number of steps.

    Returns
    -------
    SecondOpinion
        ``print(...)`` shows it.

    Raises
    ------
    InputError
        MuJoCo is not installed, the plan is one of a System, or does not repeat as often as asked.
    """
    course = Course(solution, periods)
    if not (isinstance(step, int | float) and np.isfinite(step) and step > 0):
        raise InputError(f"step = {step!r}; give a positive time [s].")
    if not (feedback is None or isinstance(feedback, Feedback)):
        raise InputError(
            f"feedback = {feedback!r}; give rt.LinearQuadratic(), rt.JointFeedback() or rt.NoFeedback(), or nothing."
        )
    away = np.asarray(offset, dtype=float).ravel()
    if away.size not in (1, 2 * course.robot.model.nv):
        raise InputError(
            f"offset has {away.size} values; give one, or {2 * course.robot.model.nv}: positions, then speeds."
        )
    feet = feet_of(course)
    softness = softness if softness is not None else Softness()
    feedback = feedback if feedback is not None else LinearQuadratic()
    limits = course.phases[0].phase.limits

    def touching(spec: Any, bodies: Any) -> None:
        furnish(course, feet, softness, spec, bodies)

    robot = mujoco_robot(course.robot, limits, touching if feet else None)
    run = _Run(course, robot, feedback, Footfalls(robot.model, feet), Fall(course.robot, _ground(feet)), bool(feet))
    run.place(away)
    for passage in course.passages:
        if not run.through(passage, float(step)):
            break
    return run.report(feedback)


def _ground(feet: Any) -> Any:
    return feet[0].ground if feet else Flat()


class _Run:
    """The state of a simulation, and what it has seen."""

    def __init__(
        self, course: Course, robot: MujocoRobot, feedback: Feedback, footfalls: Footfalls, fall: Fall, touching: bool
    ) -> None:
        self._mujoco = mujoco = load_mujoco()
        self._course, self._robot, self._footfalls, self._fall = course, robot, footfalls, fall
        self._model, self._pin = robot.model, course.robot.model
        option = self._model.opt
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST if touching else mujoco.mjtIntegrator.mjINT_RK4
        option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, IMPEDANCE_RATIO
        # A blown-up simulation is told, not started again.
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._how = "implicit Euler, soft contacts" if touching else "RK4"
        self._data = mujoco.MjData(self._model)
        self._gains = feedback.gains(course)
        self._actuation = np.asarray(course.robot.actuation, dtype=float)
        limits = course.phases[0].phase.limits
        effort = np.full(course.nu, np.inf) if limits is None else self._actuation.T @ _finite(limits.effort)
        self._effort = np.where(effort > 0, effort, np.inf)
        self._rows: list[tuple[Array, ...]] = []
        self._names: list[str] = []
        self._planned: dict[str, Array] = {}
        self._time, self._longest = 0.0, 0.0
        self._failure: str | None = None
        self._fell: float | None = None

    def place(self, offset: Array) -> None:
        """Start on the plan, or beside it."""
        nv = self._pin.nv
        start = self._course.reference(0, np.zeros(1))
        away = np.broadcast_to(offset, 2 * nv)
        q = pin.integrate(self._pin, start.q[0], np.array(away[:nv]))
        self._data.qpos[:] = self._robot.coordinates.qpos(q)
        self._data.qvel[:] = self._robot.coordinates.qvel(q, start.v[0] + away[nv:])

    def through(self, passage: Passage, step: float) -> bool:
        """Pass through a phase; False if the robot fell or the simulation blew up."""
        course = self._course
        times = course.grid(passage.phase, step)
        sizes = np.diff(times)
        self._longest = max(self._longest, float(sizes.max()))
        planned = course.reference(passage.phase, times)
        q, v = course.onwards(planned.q, planned.v, passage.period)
        # The torque is held over a step: the planned one of its middle leaves an error of second order.
        middles = times[:-1] + 0.5 * sizes
        tau = course.torques_onwards(course.reference(passage.phase, middles).tau, passage.period)
        gains = course.gains_onwards(self._gains[passage.phase], passage.period)
        pieces = np.minimum(middles / times[-1] * len(gains), len(gains) - 1).astype(int)
        self._expect(passage, middles, sizes)
        name, glance = course.phases[passage.phase].phase.name, max(1, int(GLANCE / step))
        for k, size in enumerate(sizes):
            here, gap = self._look(q[k], v[k])
            added = -gains[pieces[k]] @ gap
            torque = np.clip(tau[k] + added, -self._effort, self._effort)
            self._keep(name, q[k], v[k], here, gap, added, np.abs(torque) >= self._effort)
            if k % glance == 0 and self._fall.has(q[k], here[: self._pin.nq], gap):
                self._fell = self._time
                return False
            self._data.qfrc_applied[:] = self._robot.coordinates.force(here[: self._pin.nq], self._actuation @ torque)
            self._model.opt.timestep = size
            self._mujoco.mj_step(self._model, self._data)
            self._footfalls.watch(self._data, float(size))
            self._time += float(size)
            if not np.max(np.abs(self._data.qvel)) < DIVERGED:
                self._failure = f"MuJoCo's velocities blew up at t = {self._time:.4g} s, in phase {name!r}"
                return False
        if passage == (len(course.phases) - 1, course.periods - 1, passage.begin):
            here, gap = self._look(q[-1], v[-1])
            still = np.zeros(course.nu)
            self._keep(name, q[-1], v[-1], here, gap, still, still > 0)
        return True

    def _look(self, q: Array, v: Array) -> tuple[Array, Array]:
        """State (q, v) of the robot, and its deviation (2 nv,) from a planned one."""
        position = self._robot.coordinates.q(self._data.qpos)
        velocity = self._robot.coordinates.v(position, self._data.qvel)
        gap = np.concatenate([pin.difference(self._pin, q, position), velocity - v])
        return np.concatenate([position, velocity]), gap

    def _keep(self, name: str, *row: Any) -> None:
        self._names.append(name)
        self._rows.append((np.array([self._time]), *row))

    def _expect(self, passage: Passage, times: Array, sizes: Array) -> None:
        """Add up the planned contact forces, over which time they act."""
        planned = self._course.phases[passage.phase]
        forces = planned.at(self._course.starts[passage.phase] + times).forces
        for name in forces:
            foot, sign = self._course.foot_onwards(name, passage.period)
            impulse = sign * (sizes @ np.asarray(forces[name], dtype=float)[:, :3])
            self._planned[foot] = self._planned.get(foot, np.zeros(3)) + impulse

    def report(self, feedback: Feedback) -> SecondOpinion:
        """Sum up."""
        course, robot = self._course, self._course.robot
        times, q, v, states, gaps, added, full = (np.array(column) for column in zip(*self._rows, strict=True))
        times = times[:, 0]
        ended = self._failure is None and self._fell is None
        unit = dict(zip(robot.velocity_names, robot.units, strict=True))
        units = [TORQUE_UNITS[unit[joint]] for joint in robot.actuated]
        total = sum(course.durations) * course.periods
        expected = {name: impulse / total for name, impulse in self._planned.items()} if ended else {}
        why = self._failure if self._failure is not None else None
        nq = self._pin.nq
        return SecondOpinion(
            Simulation(times, states[:, :nq], states[:, nq:], why, self._time),
            deviation_of(robot, times, gaps, v, q, self._names, ended),
            self._footfalls.reports(expected),
            peaks(robot.actuated, units, times, added, "all"),
            float(full.mean(axis=0).max(initial=0.0)),
            self._fell,
            self._failure,
            course.periods,
            total,
            self._longest,
            str(feedback),
            f"MuJoCo {self._mujoco.__version__}, {self._how}",
        )


def _finite(values: Any) -> Array:
    return np.nan_to_num(np.asarray(values, dtype=float), posinf=0.0)
