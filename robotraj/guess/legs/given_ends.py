"""Postures that bounds and rows of positions determine at the ends of phases, and the motion between them.

A robot that reaches with a hand, crouches or stands up ends elsewhere than in its standing configuration. Inverse
kinematics finds that end, and the posture and the centre of mass move there smoothly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.curves.splines import hermite
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import MET
from robotraj._util.values import dataclass
from robotraj.guess.legs.footsteps import Footsteps
from robotraj.guess.legs.stance import BalancedStance, Errors
from robotraj.guess.reaching.position_rows import of_positions, values_at_rest
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.robot.tangent import rate_matrix


@dataclass(frozen=True, eq=False)
class GivenEnds:
    """The ends of phases of a motion that does not repeat.

    Attributes
    ----------
    steps : Footsteps
    """

    steps: Footsteps

    def posture(self, t: float) -> Array:
        """Return the reference (nq,) of joints and root at a time [s]."""
        q, change = self.steps.posture(t), self._change(t)[: self.steps.stance.robot.nv]
        return np.array(pin.integrate(self.steps.stance.robot.model, q, change)) if change.any() else q

    def com(self, t: float) -> Array:
        """Return the centre of mass (3,) at a time [m]."""
        return self.steps.com(t) + self._change(t)[-3:]

    @cached_property
    def _change(self) -> Callable[[float], Array]:
        """Return the changes of the posture (nv,) and of the centre of mass (3,), as a function of time."""
        steps = self.steps
        known = [self._at(k) for k in range(len(steps.schedule.times))] if steps.schedule.repeat is None else []
        places = [k for k, change in enumerate(known) if change is not None]
        nothing = np.zeros(steps.stance.robot.nv + 3)
        if not places:
            return lambda t: nothing
        times, values = [steps.schedule.times[k] for k in places], [known[k] for k in places]
        if places[0] > 0:
            times, values = [0.0, *times], [nothing, *values]
        if len(times) == 1:
            return lambda t: np.asarray(values[0])
        columns = [hermite(np.array(times), column, np.zeros(len(times))) for column in np.array(values).T]
        last = times[-1]
        return lambda t: np.array([float(column(min(t, last))) for column in columns])

    def _at(self, k: int) -> Array | None:
        """Return the change (nv + 3,) at the start of phase k, or at the end of the last one; None if none is given."""
        steps, phases = self.steps, self.steps.problem.phases
        t, model = steps.schedule.times[k], steps.stance.robot.model
        ends = [(phase, end) for phase, end in ((k - 1, Where.END), (k, Where.START)) if 0 <= phase < len(phases)]
        standing = steps.posture(t)
        sides = [phases[phase].joint_ends[end] for phase, end in ends]
        low = np.max([side.lower[: len(standing)] for side in sides], axis=0)
        high = np.min([side.upper[: len(standing)] for side in sides], axis=0)
        q, joints = np.clip(standing, low, high), slice(len(standing) - len(steps.stance.bounds[0]), None)
        parts = [(phases[p], of_positions(phases[p], phases[p].rows.at(end), len(q))) for p, end in ends]
        # The path of the centre of mass contains the horizontal displacement.
        own = slice(1 if steps.stance.robot.root == "planar" else 2, None)
        if not any(rows for _, rows in parts) and np.all(np.abs(q - standing)[own] < MET):
            return np.zeros(steps.stance.robot.nv + 3) if (low == high)[joints].all() else None
        com = steps.com(t)
        aim = np.array([com[0], com[1] if steps.stance.robot.root == "floating" else np.nan, np.nan])
        places, lifts = steps.feet(t)
        q = steps.stance.reach(q, places, aim, lifts, q, _errors(steps.stance, parts, (low, high), t))
        moved = np.array(pin.centerOfMass(model, steps.stance.data, q)) - com
        return np.concatenate([pin.difference(model, standing, q), moved])


def _errors(
    stance: BalancedStance,
    parts: Sequence[tuple[Phase, tuple[PhaseRow, ...]]],
    bounds: tuple[Array, Array],
    time: float,
) -> Errors:
    """Return the errors of rows on positions that apply at one end alone, and of the bounds (nq,) of q there."""
    robot, states = stance.robot, parts[0][0].body.states
    q, model = ca.SX.sym("q", robot.nq), robot.model
    rows = [row for _, own in parts for row in own]
    bounded = np.flatnonzero(np.isfinite(bounds[0]) | np.isfinite(bounds[1]))
    scales = stance.scales([row.unit for row in rows] + [states[i].unit for i in bounded])
    values = [values_at_rest(phase, own, q, time) for phase, own in parts if own]
    column = ca.vertcat(*values, *(q[int(i)] for i in bounded)) / ca.DM(scales)
    function = ca.Function("end_rows", [q], [ca.densify(column), ca.densify(ca.jacobian(column, q))])
    least, most = (
        np.array([*(getattr(row, side) for row in rows), *bound[bounded]]) / scales
        for side, bound in zip(("lower", "upper"), bounds, strict=True)
    )

    def errors(q: Array) -> tuple[Array, Array]:
        value, slope = (np.array(part) for part in function(q))
        missed = value[:, 0] - np.clip(value[:, 0], least, most)
        active = (missed != 0.0) | (least == most)
        return missed, (slope @ rate_matrix(model, q)) * active[:, None]

    return errors
