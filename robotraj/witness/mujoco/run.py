"""One simulation in MuJoCo, under planned torques and feedback, with its records.

Touchdowns set the time of the plan: a phase that begins with a touchdown begins when one of its new feet carries load.
Until then the phase before is continued with its last velocities and torques. Then the plan is shifted to the places
of these feet, as controllers of walking machines do; steps may be longer or later than planned. A foot that is to be
set down at rest comes no nearer at its last velocity: its phase begins at the planned time at the latest, and its
planned force lowers it.
Source: Westervelt et al., Feedback Control of Dynamic Bipedal Robot Locomotion (2007), section 3.4 (hybrid systems).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.mujoco.deviation import Fall, deviation_of
from robotraj.witness.mujoco.feedback import Feedback
from robotraj.witness.mujoco.feet import Foot, landing_feet, place
from robotraj.witness.mujoco.footfalls import Footfalls
from robotraj.witness.mujoco.model import MujocoRobot
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.mujoco.reference_motion import PeriodPhase, ReferenceMotion
from robotraj.witness.mujoco.report import SecondOpinion
from robotraj.witness.peak import peaks
from robotraj.witness.simulation.simulate import Simulation

DIVERGED = 1e6
"""Velocity [rad/s, m/s] above which the simulation has diverged."""

GLANCE = 0.005
"""Time between checks for a fall [s]."""

IMPEDANCE_RATIO = 10.0
"""Ratio of the stiffness of friction and normal direction; it reduces the creep of soft contacts to a tenth."""

EARLY, LATE = 0.6, 1.3
"""Shares of a phase's duration between which a touchdown ends it."""


class MujocoRun:
    """The state and the records of a simulation.

    Parameters
    ----------
    course : ReferenceMotion
    robot : MujocoRobot
    feedback : Feedback
    feet : sequence of Foot
    held : bool
        Whether soft contacts or loops act on the robot, for which RK4 is not more accurate.
    fall : Fall
    """

    def __init__(
        self,
        course: ReferenceMotion,
        robot: MujocoRobot,
        feedback: Feedback,
        feet: Sequence[Foot],
        held: bool,
        fall: Fall,
    ) -> None:
        self._mujoco = mujoco = load_mujoco()
        self._course, self._robot, self._feedback, self._fall = course, robot, feedback, fall
        self._footfalls = Footfalls(robot.model, feet)
        self._model, self._pin, self._kinematics = robot.model, course.robot.model, course.robot.model.createData()
        option = self._model.opt
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST if held else mujoco.mjtIntegrator.mjINT_RK4
        option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, IMPEDANCE_RATIO
        # A diverged simulation is reported, not reset.
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._how = "implicit Euler, soft contacts" if held else "RK4"
        self._data = mujoco.MjData(self._model)
        self._gains = feedback.gains(course)
        for planned, gains in zip(course.phases, self._gains, strict=True):
            if not np.isfinite(gains).all():
                raise InputError(
                    f"{feedback} has gains that are not finite in phase {planned.phase.name!r}: the plan is not finite "
                    "there, or too unstable; check it by rt.validate, or give rt.witness.JointFeedback()."
                )
        self._actuation = np.asarray(course.robot.actuation, dtype=float)
        self._rows: list[tuple[NDArray[np.generic], ...]] = []
        self._names: list[str] = []
        self._planned: dict[str, Array] = {}
        self._shift = np.zeros(3)
        self._time, self._longest, self._lag = 0.0, 0.0, 0.0
        self._failure: str | None = None
        self._fell: float | None = None

    def place(self, offset: Array) -> None:
        """Start at the first state of the plan, moved by (2 nv,) or one number."""
        nv = self._pin.nv
        start = self._course.reference(0, np.zeros(1))
        away = np.broadcast_to(offset, 2 * nv)
        q = pin.integrate(self._pin, start.q[0], np.array(away[:nv]))
        self._data.qpos[:] = self._robot.coordinates.qpos(q)
        self._data.qvel[:] = self._robot.coordinates.qvel(q, start.v[0] + away[nv:])

    def through(self, passage: PeriodPhase, step: float) -> bool:
        """Simulate a phase; return whether it was completed."""
        course, name = self._course, self._course.phases[passage.phase].phase.name
        weakest, strongest = course.efforts(passage.phase)
        times, coming = course.grid(passage.phase, step), self._coming(passage)
        duration = float(times[-1])
        planned = len(times) - 1
        if coming and self._strikes(passage, step):
            times = np.append(times, np.arange(duration, LATE * duration, step)[1:])
        sizes = np.diff(times)
        self._longest = max(self._longest, float(sizes.max()))
        q, v = self._extended(passage, times, duration)
        # The torque is constant over a step; the planned one at its middle has an error of second order.
        middles = times[:-1] + 0.5 * sizes
        tau = course.torques_onwards(course.reference(passage.phase, middles).tau, passage.period)
        gains = course.gains_onwards(self._gains[passage.phase], passage.period)
        pieces = np.minimum(middles / duration * len(gains), len(gains) - 1).astype(int)
        self._expect(passage, middles[:planned], sizes[:planned])
        self._anchor(passage, q[0])
        followed, glance = course.root.moved(q, self._shift), max(1, int(GLANCE / step))
        last = 0
        for k, size in enumerate(sizes):
            last = k + 1
            here, gap = self._look(followed[k], v[k])
            added = -gains[pieces[k]] @ gap
            torque = np.clip(tau[k] + added, weakest, strongest)
            self._keep(name, q[k], v[k], here, added, (torque <= weakest) | (torque >= strongest))
            if k % glance == 0 and (reason := self._fall.reason(q[k], here[: self._pin.nq], gap)) is not None:
                self._fell = self._time
                self._failure = f"the robot fell at t = {self._time:.4g} s, in phase {name!r}: {reason}"
                return False
            self._data.qfrc_applied[:] = self._robot.coordinates.force(here[: self._pin.nq], self._actuation @ torque)
            self._model.opt.timestep = size
            self._mujoco.mj_step(self._model, self._data)
            self._footfalls.watch(self._data, float(size))
            self._time += float(size)
            if not np.max(np.abs(self._data.qvel)) < DIVERGED:
                self._failure = f"MuJoCo's velocities diverged at t = {self._time:.4g} s, in phase {name!r}"
                return False
            if times[last] > EARLY * duration and self._footfalls.carry(coming):
                break
        self._lag += float(times[last]) - duration
        if passage.period == course.periods - 1 and passage.phase == len(course.phases) - 1:
            here, _ = self._look(q[last], v[last])
            none = np.zeros(course.nu)
            self._keep(name, q[last], v[last], here, none, none > 0)
        return True

    def _coming(self, passage: PeriodPhase) -> tuple[str, ...]:
        """Return the feet whose touchdown ends a phase."""
        following = passage.phase + 1
        over, phase = divmod(following, len(self._course.phases))
        if over and self._course.closing is None:
            return ()
        return tuple(self._course.foot_onwards(name, passage.period + over)[0] for name in self._course.lands(phase))

    def _strikes(self, passage: PeriodPhase, step: float) -> bool:
        """Whether the next phase begins with a larger impulse than the robot's weight gives in a step."""
        following = (passage.phase + 1) % len(self._course.phases)
        impulses = self._course.strikes(following).values()
        weight = pin.computeTotalMass(self._pin) * float(np.linalg.norm(self._pin.gravity.linear))
        return any(float(np.linalg.norm(impulse)) > weight * step for impulse in impulses)

    def _extended(self, passage: PeriodPhase, times: Array, duration: float) -> tuple[Array, Array]:
        """Return planned positions and velocities; after the end of the phase the last velocity is constant."""
        sample = self._course.reference(passage.phase, times)
        q, v = self._course.onwards(sample.q, sample.v, passage.period)
        for k in np.flatnonzero(times > duration):
            q[k] = pin.integrate(self._pin, q[k], v[k] * (times[k] - duration))
        return q, v

    def _anchor(self, passage: PeriodPhase, planned: Array) -> None:
        """Shift the plan to the places of the feet that have touched down."""
        feet = landing_feet(self._course, passage.phase, passage.period)
        if not feet or (passage.phase, passage.period) == (0, 0):
            return
        here = self._robot.coordinates.q(self._data.qpos)
        places = []
        for q in (here, planned):
            pin.framesForwardKinematics(self._pin, self._kinematics, q)
            places.append(np.mean([place(foot, self._kinematics.oMf) for foot in feet], axis=0))
        self._shift = places[0] - places[1]

    def _look(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the state (q, v) of the robot, and its deviation (2 nv,) from a planned one."""
        position = self._robot.coordinates.q(self._data.qpos)
        velocity = self._robot.coordinates.v(position, self._data.qvel)
        gap = np.concatenate([pin.difference(self._pin, q, position), velocity - v])
        return np.concatenate([position, velocity]), gap

    def _keep(self, name: str, q: Array, v: Array, here: Array, added: Array, full: NDArray[np.bool_]) -> None:
        """Record the plan, the robot, the added torques and the saturated motors."""
        away = np.concatenate([pin.difference(self._pin, q, here[: self._pin.nq]), here[self._pin.nq :] - v])
        self._names.append(name)
        self._rows.append((np.array([self._time]), q, v, here, away, added, full))

    def _expect(self, passage: PeriodPhase, times: Array, sizes: Array) -> None:
        """Sum the impulses of the planned contact forces and impacts."""
        planned = self._course.phases[passage.phase]
        forces = planned.at(self._course.starts[passage.phase] + times).forces
        impulses = {name: sizes @ np.asarray(forces[name], dtype=float)[:, :3] for name in forces}
        if (passage.phase, passage.period) != (0, 0):
            for name, impulse in self._course.strikes(passage.phase).items():
                impulses[name] = impulses[name] + impulse
        for name, parts in impulses.items():
            foot, sign = self._course.foot_onwards(name, passage.period)
            impulse = sign * parts
            self._planned[foot] = self._planned.get(foot, np.zeros(3)) + impulse

    def report(self) -> SecondOpinion:
        """Return the report."""
        course, robot = self._course, self._course.robot
        times, q, v, states, gaps, added, full = (np.array(column) for column in zip(*self._rows, strict=True))
        times = times[:, 0]
        ended = self._failure is None
        unit = dict(zip(robot.velocity_names, robot.units, strict=True))
        units = [TORQUE_UNITS[unit[joint]] for joint in robot.actuated]
        total = sum(course.durations) * course.periods
        expected = {name: impulse / total for name, impulse in self._planned.items()} if ended else {}
        nq = self._pin.nq
        return SecondOpinion(
            Simulation(times, states[:, :nq], states[:, nq:], self._failure, self._time),
            deviation_of(robot, times, gaps, v, q, self._names, ended),
            self._footfalls.reports(expected),
            peaks(robot.actuated, units, times, added, "all"),
            float(full.mean(axis=0).max(initial=0.0)),
            self._fell,
            self._failure,
            course.periods,
            total,
            self._lag,
            self._longest,
            str(self._feedback),
            f"MuJoCo {self._mujoco.__version__}, {self._how}",
        )
