"""Quality of a plan of a walk, computed with Pinocchio from samples of the tool's interpolant.

Samples, with K intervals, S times each, F feet: t (K, S), q (K, S, nq), v and a (K, S, nv), tau (K, S, nu), force
(K, S, F, 6) on each foot in world axes at its frame [N, N m], stands (K, F).
"""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from walks import Walk

ROOT = 6


def judge(walk: Walk, model: pin.Model, plan: Any, periodic: bool) -> dict[str, float]:
    """Figures of one plan, SI units; excesses are 0 where a limit holds.

    A periodic plan's footholds are where its period has them: the root's way is what can be missed.
    """
    q, v, a, tau, force, t = (plan[name] for name in ("q", "v", "a", "tau", "force", "t"))
    stands = plan["stands"].astype(bool)
    data = model.createData()
    weight = pin.computeTotalMass(model) * 9.81
    feet = [model.getFrameId(name) for name in walk.feet]
    places, turns, residual = _kinematics(model, data, feet, plan)
    every = np.broadcast_to(stands[:, None], force.shape[:3])
    tangential = np.linalg.norm(force[..., :2], axis=-1)
    least = np.where(every, force[..., 2], np.inf)
    broken = np.where(every, tangential - walk.friction * force[..., 2], -np.inf)
    pressed = np.where(every, _pressure(walk.sole, force, turns, weight), 0.0)
    boxed = np.where(every, _pressure(walk.box, force, turns, weight), 0.0)
    slip, sink = _slip(places, stands)
    level = float(np.mean(places[0, 0, :, 2]))
    limits = model.effortLimit[ROOT:]
    drift, defect = _simulate(model, data, feet, plan, walk.sole is not None)
    first, last = places[0, 0], places[-1, -1]
    steps = dict.fromkeys(walk.feet, 0.0)
    for moved, share, _ in walk.phases():
        for foot in moved:
            steps[foot] += share
    way = float(q[-1, -1, 0] - q[0, 0, 0])
    missed = max(
        float(np.hypot(last[i, 0] - first[i, 0] - steps[f], last[i, 1] - first[i, 1])) for i, f in enumerate(walk.feet)
    )
    if periodic:
        missed = abs(way - 0.5 * walk.length)
    powers = np.abs(tau * v[..., ROOT:]).sum(-1)
    return {
        "over position": _over(q[..., 7:], model.lowerPositionLimit[7:], model.upperPositionLimit[7:]),
        "over speed": _over(v[..., ROOT:], -model.velocityLimit[ROOT:], model.velocityLimit[ROOT:]),
        "over torque": float(np.max(np.abs(tau) / limits - 1.0).clip(0.0)),
        "cone": max(0.0, float(np.max(broken)) / weight),
        "cone time": float(np.mean(np.max(broken, axis=(1, 2)) > 1e-6 * weight)),
        "pull": max(0.0, -float(np.min(least)) / weight),
        "pressure": float(np.max(pressed)),
        "box": float(np.max(boxed)),
        "slip": slip,
        "sink": sink,
        "off ground": float(np.max(np.where(every, np.abs(places[..., 2] - level), 0.0))),
        "lowest swing": float(np.min(np.where(every, 0.0, places[..., 2] - level))),
        "apex": float(min(np.max(places[..., i, 2]) - level for i in range(len(feet)) if not stands[:, i].all())),
        "step missed by": missed,
        "equations": float(np.max(np.abs(residual[..., ROOT:]))),
        "equations root": float(np.max(np.abs(residual[..., :3]))) / weight,
        "drift": drift,
        "defect": defect,
        "way": way,
        "time": float(t[-1, -1] - t[0, 0]),
        "effort": float(np.sum(np.trapezoid(np.sum(tau**2, -1), t, axis=1))),
        "transport": float(np.sum(np.trapezoid(powers, t, axis=1))) / weight / way,
        "end speed": float(np.max(np.abs(v[-1, -1]))),
    }  # fmt: skip


def _over(values: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> float:
    """Largest excess over a limit [unit of the values]."""
    return float(np.max(np.maximum(values - upper, lower - values)).clip(0.0))


def _kinematics(model: pin.Model, data: pin.Data, feet: list[int], plan: Any) -> tuple[np.ndarray, ...]:
    """Feet's places and rotations, and M a + h - S' tau - J' f."""
    shape = plan["t"].shape
    places, turns = np.empty((*shape, len(feet), 3)), np.empty((*shape, len(feet), 3, 3))
    residual = np.empty((*shape, model.nv))
    for k, s in np.ndindex(*shape):
        q, v, a = (plan[name][k, s] for name in "qva")
        row = pin.rnea(model, data, q, v, a).copy()
        row[ROOT:] -= plan["tau"][k, s]
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        for i, foot in enumerate(feet):
            places[k, s, i], turns[k, s, i] = data.oMf[foot].translation, data.oMf[foot].rotation
            if plan["stands"][k, i]:
                jacobian = pin.getFrameJacobian(model, data, foot, pin.LOCAL_WORLD_ALIGNED)
                row -= jacobian.T @ plan["force"][k, s, i]
        residual[k, s] = row
    return places, turns, residual


def _pressure(sole: tuple[float, float] | None, force: np.ndarray, turns: np.ndarray, weight: float) -> np.ndarray:
    """How far [m] the centre of pressure is outside the sole, where it carries a twentieth of the weight."""
    if sole is None:
        return np.zeros(force.shape[:3])
    own = np.einsum("ksfji,ksfj->ksfi", turns, force[..., :3])
    moment = np.einsum("ksfji,ksfj->ksfi", turns, force[..., 3:])
    carries = own[..., 2] > 0.05 * weight
    normal = np.where(carries, own[..., 2], 1.0)
    outside = np.maximum(np.abs(moment[..., 1]) / normal - sole[0] / 2, np.abs(moment[..., 0]) / normal - sole[1] / 2)
    return np.where(carries, outside.clip(0.0), 0.0)


def _slip(places: np.ndarray, stands: np.ndarray) -> tuple[float, float]:
    """Largest horizontal and vertical distance [m] of a standing foot from where its stance began."""
    slip = sink = 0.0
    for i in range(places.shape[2]):
        for held, run in groupby(range(len(stands)), key=lambda k, i=i: bool(stands[k, i])):
            intervals = list(run)
            if held:
                moved = places[intervals, :, i] - places[intervals[0], 0, i]
                slip = max(slip, float(np.max(np.hypot(moved[..., 0], moved[..., 1]))))
                sink = max(sink, float(np.max(np.abs(moved[..., 2]))))
    return slip, sink


def _simulate(model: pin.Model, data: pin.Data, feet: list[int], plan: Any, flat: bool) -> tuple[float, float]:
    """Accurate simulation under the planned torques with the standing feet's accelerations zero.

    Phases and intervals are simulated from their planned starts. Returns the largest joint or root error at the end of
    a phase [rad, m]. The second value is the largest error of an interval relative to its length [rad/s, m/s].
    """
    stands, rows = plan["stands"].astype(bool), 6 if flat else 3
    nq = model.nq
    drift = defect = 0.0
    for _, run in groupby(range(len(stands)), key=lambda k: stands[k].tobytes()):
        state = None
        for k in run:
            planned = np.r_[plan["q"][k, 0], plan["v"][k, 0]]
            held = [foot for foot, on in zip(feet, stands[k], strict=True) if on]
            times = plan["t"][k] - plan["t"][k, 0]
            torque = make_interp_spline(times, plan["tau"][k], k=3)

            def rate(s: float, x: np.ndarray, torque: Any = torque, held: Any = held) -> np.ndarray:
                return _rate(model, data, x, torque(s), held, rows)

            def forward(x: np.ndarray, rate: Any = rate, times: Any = times) -> np.ndarray:
                return solve_ivp(rate, (0.0, times[-1]), x, method="DOP853", rtol=1e-8, atol=1e-9).y[:, -1]

            # The plan's next knot within a phase is the end of this interval's interpolant.
            target = plan["q"][k, -1]
            one = forward(planned)
            defect = max(defect, _distance(model, one[:nq], target) / times[-1])
            state = one if state is None else forward(state)
            error = _distance(model, state[:nq], target)
        drift = max(drift, error)
    return drift, defect


def _distance(model: pin.Model, q: np.ndarray, p: np.ndarray) -> float:
    return float(np.max(np.abs(pin.difference(model, pin.normalize(model, q), pin.normalize(model, p)))))


def _rate(
    model: pin.Model, data: pin.Data, x: np.ndarray, torque: np.ndarray, held: list[int], rows: int
) -> np.ndarray:
    """Rate of (q, v): M a - J' f = S' tau - h, J a = -J' v."""
    q, v = pin.normalize(model, x[: model.nq]), x[model.nq :]
    pin.computeAllTerms(model, data, q, v)
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    pin.updateFramePlacements(model, data)
    jacobian = np.vstack([pin.getFrameJacobian(model, data, f, pin.LOCAL_WORLD_ALIGNED)[:rows] for f in held])
    bias = np.concatenate(
        [pin.getFrameClassicalAcceleration(model, data, f, pin.LOCAL_WORLD_ALIGNED).vector[:rows] for f in held]
    )
    n, m = model.nv, len(jacobian)
    matrix = np.zeros((n + m, n + m))
    matrix[:n, :n] = np.triu(data.M) + np.triu(data.M, 1).T
    matrix[:n, n:], matrix[n:, :n] = -jacobian.T, jacobian
    right = np.r_[np.r_[np.zeros(ROOT), torque] - data.nle, -bias]
    # The root's quaternion: half its product with the angular velocity in the body's frame.
    turn = x[3:7]
    w = v[3:6]
    spin = 0.5 * np.r_[turn[3] * w + np.cross(turn[:3], w), -turn[:3] @ w]
    place = pin.Quaternion(q[3:7]).toRotationMatrix() @ v[:3]
    return np.r_[place, spin, v[6:], np.linalg.solve(matrix, right)[:n]]
