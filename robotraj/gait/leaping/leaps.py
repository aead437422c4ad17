"""What jumps and flips share: motions from standing to standing with one flight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.bounds.margins import checked_margin
from robotraj.gait.bounds.turning import Turning
from robotraj.gait.capability.leg_samples import greatest_friction
from robotraj.gait.capability.weight import check_push, check_rest
from robotraj.gait.checks import number
from robotraj.gait.feet import foot_contact
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.posture import posture_objective
from robotraj.gait.repetition import on_ground
from robotraj.gait.supports import GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import pendulum_time, standing
from robotraj.problem.constraints.bounds import as_duration
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION

CROUCH = 2.5
"""Default duration of either stance, in sqrt(h / g): a person crouches and rises in 0.7 s.

In 0.3 s five_link, talos_legs and monopod ended at their limits of torque and speed, or without a motion."""


@dataclass(frozen=True, eq=False)
class Leap:
    """A motion from standing to standing with one flight.

    Attributes
    ----------
    robot : Robot
    feet : tuple of str
        Frames of the feet.
    options : GaitTerms
        Options of all phases; ``upright`` may be a ``Turning``.
    call : str
        Name of the public function, for messages.
    length : float
        Displacement along x [m].

    Raises
    ------
    InputError
        A number is invalid, or the legs cannot carry the robot at rest.
    """

    robot: Robot
    feet: tuple[str, ...]
    options: GaitTerms
    call: str
    length: float

    def __post_init__(self) -> None:
        number(self.length, f"rt.gait.{self.call}(length)")
        check_rest(self.robot, self.feet, self.standing, self.friction, self.margin)

    @cached_property
    def terms(self) -> GaitTerms:
        """Return the options with contacts on the ground and with an objective."""
        options = self.options
        cost = posture_objective(self.robot, self.standing) if options.objective is None else options.objective
        return replace(options, contact=on_ground(options.contact, options.ground), objective=cost)

    @cached_property
    def stance(self) -> BalancedStance:
        """Return the inverse kinematics of the standing robot."""
        kind = on_ground(self.options.contact, self.options.ground)
        return BalancedStance(self.robot, tuple(foot_contact(kind, name).bound_to(self.robot) for name in self.feet))

    @cached_property
    def standing(self) -> Array:
        """Return the first configuration (nq,)."""
        return standing(self.stance)

    @cached_property
    def landed(self) -> Array:
        """Return the last configuration (nq,), one turn later if the robot turns."""
        landed, planar = np.array(self.standing), self.robot.root == "planar"
        landed[0] += self.length
        landed[1 if planar else 2] += self._level(landed) - self._level(self.standing)
        if isinstance(self.terms.upright, Turning):
            if planar:
                landed[2] += 2.0 * np.pi * self.terms.upright.axis[1]
            else:
                landed[QUATERNION] *= -1.0
        return landed

    @property
    def margin(self) -> float:
        """Return the share that the plan keeps back."""
        return checked_margin(self.options.margin)

    @cached_property
    def friction(self) -> float:
        """Return the friction coefficient of the feet, at most 1."""
        return greatest_friction(self.stance)

    @property
    def gravity(self) -> float:
        """Return the acceleration of free fall [m/s^2]."""
        return float(np.linalg.norm(self.robot.model.gravity.linear))

    @property
    def stance_time(self) -> float:
        """Return the default duration of the push and of the landing [s]."""
        return CROUCH * pendulum_time(self.stance, self.standing)

    def rise(self, height: object) -> float:
        """Return a checked rise of the centre of mass in flight [m].

        Raises
        ------
        InputError
            It is not positive.
        """
        found = number(height, f"rt.gait.{self.call}(height)")
        if not found > 0.0:
            raise InputError(f"rt.gait.{self.call}: height= is {height!r}; give a positive height [m].")
        return found

    def problem(self, height: float, pushes: Sequence[Support], landings: Sequence[Support]) -> Problem:
        """Return the problem of the pushes, a flight that rises by ``height`` [m], and the landings.

        Raises
        ------
        InputError
            The pushes are too short for the torques of the legs.
        """
        time = sum(as_duration(push.duration, push.name)[1] for push in pushes)

        def remedy(enough: float) -> str:
            return f"push={max(enough, self.stance_time) if np.isfinite(enough) else self.stance_time:.2g}"

        check_push(self.robot, self.feet, self.standing, height, time, self.friction, self.margin, remedy)
        flight = Support((), float(np.sqrt(8.0 * height / self.gravity)), "flight")
        start, end = (State(q=q, v=0.0) for q in (self.standing, self.landed))
        return sequence(self.robot, [*pushes, flight, *landings], self.terms, None, start, end)

    def _level(self, q: Array) -> float:
        """Return the mean height of the ground under the feet [m]."""
        data, ground = self.robot.model.createData(), as_ground(self.terms.ground)
        pin.framesForwardKinematics(self.robot.model, data, q)
        places = [data.oMf[self.robot.frame(name)].translation for name in self.feet]
        return float(np.mean([ground.height(float(p[0]), float(p[1])) for p in places]))
