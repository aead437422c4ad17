"""Ends of a motion at rest that the motors cannot hold: static torques beyond their limits.

A pose is held at rest if torques and contact forces balance gravity, 0 = RNEA(q, 0, 0) - B tau - J' f, within their
limits and dry friction. The least excess e over the torque limits solves a linear program,

    minimise  sum_j e_j / size_j    subject to the balance,  lower_j - e_j <= tau_j <= upper_j + e_j,  f_normal >= 0,

with the larger magnitude of both limits as the size.
A robot can pass through such a pose, and can even reach it while gravity slows it down. Such ends are therefore not
refused. They are reported as a cause where a solve fails.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.precision import MET
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.dynamics.terrain.flat import Flat
from robotraj.problem.constraints.base import Where, symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.solution.conflict import Conflict

UNLIMITED = 1e12
"""Torque [N m, N] in place of an infinite limit."""


def unheld_ends(problem: Problem) -> tuple[Conflict, ...]:
    """Return the torque limits that are too small to hold a fixed end at rest, the largest relative excess first.

    The torques that hold it are the needed bounds; of both ends of a phase, the greater ones. Phases of Systems and
    phases with design parameters are skipped, and so are poses that no torque balances.
    """
    found = [conflict for phase in problem.phases for conflict in _unheld(phase)]
    greatest: dict[tuple[str, str], Conflict] = {}
    for conflict in sorted(found, key=lambda conflict: -conflict.relative):
        greatest.setdefault((conflict.phase, conflict.name), conflict)
    return tuple(greatest.values())


def _unheld(phase: Phase) -> list[Conflict]:
    robot, limits = phase.robot, phase.limits
    if robot is None or not isinstance(limits, Limits) or phase.design:
        return []
    size = robot.nq + robot.nv
    joints = [list(limits.joints).index(joint) for joint in robot.actuated]
    allowed = Bounds(*(np.asarray(side)[joints] for side in limits.sides("effort")))
    data, found = robot.model.createData(), []
    for end, bounds in phase.joint_ends.items():
        lower, upper = bounds.lower[:size], bounds.upper[:size]
        if not np.array_equal(lower, upper) or np.any(lower[robot.nq :]):
            continue
        time = phase.duration_bounds[1] if end is Where.END else 0.0
        excess = _least_excess(phase, lower, allowed, data)
        for joint, i, low, high, over in zip(robot.actuated, joints, *allowed, excess, strict=True):
            # Limits of one magnitude are stated as that.
            over, limit = (abs(over), high) if low == -high else (over, high if over > 0.0 else low)
            largest = max(-low, high)
            if abs(over) > MET * largest:
                found.append(
                    Conflict(
                        phase.name,
                        f"effort limit, {joint}",
                        time,
                        float(limit),
                        float(limit + over),
                        "N m" if robot.units[i] == "rad" else "N",
                        float(abs(over) / largest),
                        True,
                        f"holding the {end.value} needs it",
                    )
                )
    return found


def _least_excess(phase: Phase, state: Array, allowed: Bounds, data: pin.Data) -> Array:
    """Return the excess (nu,) [N m, N] of the torques that hold a state, negative below a lower limit.

    It is 0 where no torque holds the state.
    """
    robot = phase.robot
    assert robot is not None
    friction = np.asarray(robot.friction, dtype=float)
    if not phase.contacts and (robot.nu == robot.nv or not friction.any()):
        return _excess_without_contacts(robot, state, allowed, friction, data)
    body = InverseDynamics().of(robot, None, phase.bound_contacts)
    point = cast(RobotPoint, symbols_of(body, phase.parameter_names))
    columns = [ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.z, point.u, point.p)]
    x, z, u, p = columns
    residual = body.residual(point)
    forces, nv, nu = z[robot.nv :, 0], robot.nv, robot.nu
    parts = [residual, ca.jacobian(residual, u), ca.jacobian(residual, forces)]
    evaluate = ca.Function("balance", [x, z, u, p, point.t], parts)
    values = evaluate(state, np.zeros(z.numel()), np.zeros(nu), np.zeros(p.numel()), 0.0)
    load, by_torques, by_forces = (np.array(ca.DM(value).full())[:nv] for value in values)
    limits = phase.rows.limits()
    least = [0.0 if limits.get(v.name, (-np.inf, np.inf))[0] >= 0.0 else -np.inf for v in body.algebraic[nv:]]
    lowest, most = np.maximum(allowed.lower, -UNLIMITED), np.minimum(allowed.upper, UNLIMITED)
    size = np.maximum(-lowest, most)
    if _held_easily(load.ravel(), by_torques, by_forces, Bounds(lowest / size, most / size), size, np.array(least)):
        return np.zeros(nu)
    from scipy.optimize import linprog

    # Unknowns: torques, excess, contact forces, dry friction.
    weights = np.concatenate([np.zeros(nu), 1.0 / size])
    cost = np.concatenate([weights, np.zeros(len(least) + nv)])
    balance = np.hstack([by_torques, np.zeros((nv, nu)), by_forces, np.eye(nv)])
    within = np.hstack([np.eye(nu), -np.eye(nu), np.zeros((nu, len(least) + nv))])
    both = np.vstack([within, within * np.where(np.arange(within.shape[1]) < nu, -1.0, 1.0)])
    slipping = _friction_rows(phase, [variable.name for variable in body.algebraic[nv:]])
    cones = np.hstack([np.zeros((len(slipping), 2 * nu)), slipping, np.zeros((len(slipping), nv))])
    ranges = [(None, None)] * nu + [(0.0, None)] * nu + [(low, None) for low in least]
    ranges += [(-size, size) for size in friction]
    above = np.concatenate([most, -lowest, np.zeros(len(slipping))])
    found = linprog(cost, np.vstack([both, cones]), above, balance, -load.ravel(), ranges)
    if found.status != 0:
        return np.zeros(nu)
    return np.where(found.x[:nu] >= 0.5 * (lowest + most), 1.0, -1.0) * found.x[nu : 2 * nu]


def _excess_without_contacts(robot: Robot, state: Array, allowed: Bounds, friction: Array, data: pin.Data) -> Array:
    """Return the excess of the only torques that balance gravity and springs; zeros where an unmotored joint falls."""
    gravity = pin.computeGeneralizedGravity(robot.model, data, state[: robot.nq])
    gravity = gravity + robot.resistance(state[: robot.nq], np.zeros(robot.nv))
    torques = robot.actuation.T @ gravity
    left = float(np.abs(robot.actuation @ torques - gravity).max(initial=0.0))
    if left >= MET * max(1.0, float(np.abs(gravity).max(initial=0.0))):
        return np.zeros(robot.nu)
    held = robot.actuation.T @ friction
    above, below = torques - held - allowed.upper, torques + held - allowed.lower
    return np.maximum(0.0, above) + np.minimum(0.0, below)


def _friction_rows(phase: Phase, forces: Sequence[str]) -> Array:
    """Return rows (m, forces) of |f_x| <= mu f_z and |f_y| <= mu f_z on level ground; they contain the cone."""
    rows = []
    for bound in phase.bound_contacts:
        contact = bound.contact
        normal = f"force.{bound.name}.z"
        if not isinstance(contact.ground, Flat) or normal not in forces:
            continue
        for axis in "xy":
            name = f"force.{bound.name}.{axis}"
            for sign in (1.0, -1.0) if name in forces else ():
                row = np.zeros(len(forces))
                row[forces.index(name)], row[forces.index(normal)] = sign, -contact.friction
                rows.append(row)
    return np.array(rows).reshape(len(rows), len(forces))


def _held_easily(load: Array, by_torques: Array, by_forces: Array, relative: Bounds, size: Array, least: Array) -> bool:
    """Whether the balance of least norm, with torques relative to their sizes (nu,), keeps every ``relative`` limit.

    No linear program is needed then.
    """
    weight = max(float(np.abs(load).max(initial=0.0)), 1.0)
    columns = np.hstack([by_torques * size, by_forces * weight])
    found = np.linalg.lstsq(columns, -load, rcond=1e-10)[0]
    nu = by_torques.shape[1]
    balanced = float(np.abs(columns @ found + load).max(initial=0.0)) < MET * weight
    within = np.all(found[:nu] >= relative.lower) and np.all(found[:nu] <= relative.upper)
    return balanced and bool(within and np.all(found[nu:] >= np.where(least < 0.0, -np.inf, 0.0)))
