"""The residual of the dynamics between the collocation points."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.tangent import velocities
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.numbers import as_numbers
from robotraj.witness.peak import Peak, peaks
from robotraj.witness.planned import robot_sample, system_of
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.plants.plant import RATE_UNITS
from robotraj.witness.plants.system_plant import columns
from robotraj.witness.point import system_point
from robotraj.witness.protocols import PhaseSolutionLike
from robotraj.witness.sampling import interval_samples, time_derivative

TORQUE_UNITS = {"rad": "N m", "m": "N"}

FEWEST_SAMPLES = 25
"""Least samples of an interval, enough for the degree of the planned polynomials."""


Peaks = tuple[dict[str, Peak], dict[str, Peak]]


@dataclass(frozen=True)
class Residual(OneLine):
    """Residuals of the differential equations along the planned polynomials.

    Both are zero at the collocation points up to the solver's tolerance; between them they measure the
    discretisation error.

    dq/dt, dv/dt and dx/dt are derivatives of the planned polynomials.

    Attributes
    ----------
    dynamics : mapping of str to Peak
        Robots, by joint: max over t of |RNEA(q, v, dv/dt) + d(v) - B tau - J' f| [N m, N], f the contact forces.
        Systems, by algebraic row: |g|.
    rate : mapping of str to Peak
        Robots, by joint: max over t of |dq/dt - v| [rad/s, m/s]; of a floating root in its own axes.
        Systems, by state: |dx/dt - f(x, z, u, p, t)|.
    jumps : mapping of str to Peak
        By state: largest gap at a knot between the polynomials of its two intervals, zero after convergence.
    """

    dynamics: Mapping[str, Peak]
    rate: Mapping[str, Peak]
    jumps: Mapping[str, Peak]


def residual_of(planned: PhaseSolutionLike, samples: int, clock: Callable[[], None] = lambda: None) -> Residual:
    """Return both residuals at ``samples`` points of every interval, ``FEWEST_SAMPLES`` at least."""
    samples = max(samples, FEWEST_SAMPLES)
    if not list(interval_samples(planned, samples)):
        return Residual({}, {}, {})
    dynamics, rate = (_robot if planned.phase.robot is not None else _system)(planned, samples, clock)
    return Residual(dynamics, rate, _jumps(planned))


def _jumps(planned: PhaseSolutionLike) -> dict[str, Peak]:
    """Return the gaps between the polynomials that meet at each knot."""
    plant, knots = plant_of(planned), np.asarray(planned.knots, dtype=float)
    used = np.flatnonzero(np.diff(knots) > 0.0)
    if len(used) < 2:
        return {}
    times = knots[used[1:]]
    gaps = plant.gaps(plant.states(times, used[1:]), plant.states(times, used[:-1]))
    return peaks(plant.gap_names, plant.gap_units, times, gaps, planned.phase.name)


def _robot(planned: PhaseSolutionLike, samples: int, clock: Callable[[], None]) -> Peaks:
    robot = realised(planned)
    data = robot.model.createData()
    actuation = np.asarray(robot.actuation, dtype=float)
    contacts = planned.phase.bound_contacts
    stance = Stance(robot, contacts, planned.parameters)
    times: list[Array] = []
    torque: list[Array] = []
    rate: list[Array] = []
    for part in interval_samples(planned, samples):
        clock()
        sample = robot_sample(planned, part.times, part.interval)
        acceleration = time_derivative(sample.v, part)
        for i, (q, v, a, tau) in enumerate(zip(sample.q, sample.v, acceleration, sample.tau, strict=True)):
            needed = pin.rnea(robot.model, data, q, v, a) + robot.resistance(q, v) - actuation @ tau
            torque.append(needed - stance.torques(q, forces_in(sample, contacts, i)) if contacts else needed)
        rate.append(velocities(robot.model, sample.q, time_derivative(sample.q, part)) - sample.v)
        times.append(part.times)
    t, name = np.concatenate(times), planned.phase.name
    joints = robot.velocity_names
    return (
        peaks(joints, [TORQUE_UNITS[u] for u in robot.units], t, np.array(torque), name),
        peaks(joints, [RATE_UNITS[u] for u in robot.units], t, np.concatenate(rate), name),
    )


def _system(planned: PhaseSolutionLike, samples: int, clock: Callable[[], None]) -> Peaks:
    system = system_of(planned)
    states, controls, algebraic = (
        tuple(v.name for v in kind) for kind in (system.states, system.controls, system.algebraic)
    )
    times: list[Array] = []
    rows: list[Array] = []
    rate: list[Array] = []
    for part in interval_samples(planned, samples):
        clock()
        sample = planned.at(part.times, interval=part.interval)
        x, u, z = (
            columns(named, names, len(part.times))
            for named, names in ((sample.x, states), (sample.u, controls), (sample.z, algebraic))
        )
        slope = time_derivative(x, part)
        for i, t in enumerate(part.times):
            point = system_point(system, t, x[i], z[i], u[i], planned.parameters)
            rate.append(slope[i] - as_numbers(system.dynamics(point), "dynamics"))
            if system.residual is not None:
                rows.append(as_numbers(system.residual(point), "residual"))
        times.append(part.times)
    t, name = np.concatenate(times), planned.phase.name
    units = [f"{s.unit}/s" if s.unit else "" for s in system.states]
    dynamics = {}
    if rows:
        named_rows = [f"residual {i}" for i in range(len(rows[0]))]
        dynamics = peaks(named_rows, [""] * len(named_rows), t, np.array(rows), name)
    return dynamics, peaks(states, units, t, np.array(rate), name)
