"""What the smooth law of dry friction leaves out of Coulomb's, as a share of a plan's objective.

The friction F tanh(v / v_s) is less than Coulomb's F sign(v) where a joint moves more slowly than v_s. Along the
planned motion q(t), Coulomb's law takes the torques tau + d, with

    d_i = F_i (sign(v_i) - tanh(v_i / v_s)) [v_i moves].

By the envelope theorem the optimum changes to first order as the objective along this motion, whose integrand is l:

    | sum integral (l(tau + d) - l(tau)) dt | / J.

Terms of the end points, such as a duration, depend on torques at their limits alone. There the share of a joint's
impulse at the limits of its motor counts, which are 0 without one,

    max_i integral |d_i| [at the limit] dt / max(integral |M a|_i dt, ``SHARE`` integral |tau_i| dt),

times the part of the objective that such terms are. Both fall in proportion to v_s.
Source: Bryson and Ho, Applied Optimal Control (1975), 2.3, on the change of an optimum with a parameter.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.fixed_mesh.sizes.shares import PLACES, WEIGHTS, shares_of
from robotraj.planning.proving.soft_friction import has_friction
from robotraj.problem.constraints.bounds import UNBOUNDED
from robotraj.problem.phase import Phase
from robotraj.robot.robot import Robot
from robotraj.solution.claims.objective_size import size_for
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.proof import FRICTION
from robotraj.solution.sample import Sample
from robotraj.solution.solution import Solution
from robotraj.transcription.refinement.objective_quadrature import rate_of

SHARE = 0.1
"""Least size of a joint's impulse relative to that of its motor: a slow joint has hardly any inertia."""
AT_LIMIT = 0.99
"""Share of its limit from which a torque is at the limit."""
STILL = 3e-3
"""Speed below which a joint rests, relative to its largest: its friction takes any value up to F."""


@dataclass(frozen=True)
class LeftOut:
    """Shares of Coulomb's friction that the smooth law leaves out: of the objective, and of a joint's impulse."""

    objective: float
    impulse: float


def friction_left_out(found: Solution) -> LeftOut:
    """Return what the smooth law of dry friction leaves out of a plan; nothing without dry friction."""
    parts = [part for part in found.phases if has_friction(part.phase)]
    if not parts:
        return LeftOut(0.0, 0.0)
    shares, limited, added = zip(*map(_left_out, parts), strict=True)
    integrals = abs(float(sum(added)))
    size = size_for(integrals, FRICTION, found.phases, found.objective)
    return LeftOut(integrals / size + shares_of(found.problem).ends * float(max(limited)), float(max(shares)))


def _left_out(part: PhaseSolution) -> tuple[float, float, float]:
    """Return the largest shares of a joint's impulse, anywhere and at its limits, and what the integrals lack."""
    robot = part.phase.robot
    assert robot is not None
    knots = np.asarray(part.knots, dtype=float)
    lengths = np.diff(knots)
    times = (knots[:-1, None] + lengths[:, None] * PLACES).ravel()
    weights = (lengths[:, None] * WEIGHTS).ravel()
    sample = part.at(times)
    moves = np.abs(sample.v) > STILL * np.abs(sample.v).max(axis=0)
    lacking = moves * robot.friction * (np.sign(sample.v) - np.tanh(sample.v / robot.friction_speed))
    actuation = np.asarray(robot.actuation, dtype=float)
    motors = sample.tau @ actuation.T
    low, high = (side @ actuation.T for side in _limits(part.phase, robot))
    room = (1.0 - AT_LIMIT) * np.maximum(np.abs(low), np.abs(high))
    over = np.maximum(motors, motors + lacking) >= high - room
    at_limit = over | (np.minimum(motors, motors + lacking) <= low + room)
    size = np.maximum(weights @ np.abs(_inertial(robot, sample)), SHARE * (weights @ np.abs(motors)))
    return (
        _share(weights @ np.abs(lacking), size),
        _share(weights @ np.abs(lacking * at_limit), size),
        _of_integrals(part, times, sample, weights, lacking @ actuation),
    )


def _limits(phase: Phase, robot: Robot) -> tuple[Array, Array]:
    """Return the least and the largest torques (nu,) that the limits of a phase allow; large ones without limits."""
    known = {each.name: each for each in (*phase.dae.controls, *phase.dae.algebraic)}
    torques = tuple(known[name] for joint in robot.actuated if (name := f"tau.{joint}") in known)
    if len(torques) < len(robot.actuated):
        return np.full(robot.nu, -UNBOUNDED), np.full(robot.nu, UNBOUNDED)
    low, high = phase.rows.limits_of(torques)
    return np.maximum(low, -UNBOUNDED), np.minimum(high, UNBOUNDED)


def _share(missing: Array, size: Array) -> float:
    return float(np.max(np.divide(missing, size, out=np.zeros_like(missing), where=size > 0.0)))


def _inertial(robot: Robot, sample: Sample[Array]) -> Array:
    """Return M a (m, nv)."""
    data, still = robot.model.createData(), np.zeros(robot.nv)
    return np.array(
        [
            pin.rnea(robot.model, data, q, still, a) - pin.rnea(robot.model, data, q, still, still)
            for q, a in zip(sample.q, sample.a, strict=True)
        ]
    )


def _of_integrals(part: PhaseSolution, times: Array, sample: Sample[Array], weights: Array, torques: Array) -> float:
    rate, dae, robot = rate_of(part.phase, of_motion=True), part.phase.dae, part.phase.robot
    if rate is None or robot is None:
        return 0.0
    more = {f"tau.{joint}": torques[:, i] for i, joint in enumerate(robot.actuated)}
    parameters = np.array([part.parameters[name] for name in part.phase.parameter_names], dtype=float)
    values = []
    for change in ({}, more):
        kinds = ((sample.x, dae.states), (sample.z, dae.algebraic), (sample.u, dae.controls))
        columns = [
            np.array([named[v.name] + change.get(v.name, 0.0) for v in kind]).reshape(len(kind), len(times))
            for named, kind in kinds
        ]
        repeated = np.tile(parameters[:, None], len(times))
        values.append(np.array(rate.map(len(times))(times[None], *columns, repeated)).ravel())
    return float(weights @ (values[1] - values[0]))
