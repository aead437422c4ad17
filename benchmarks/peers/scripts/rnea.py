"""Inverse dynamics of a URDF as a CasADi graph, in forty lines: recursive Newton-Euler in body frames.

Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 5.3; linear part of a spatial acceleration.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin

AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


def axis_of(joint: Any) -> tuple[bool, np.ndarray]:
    """Whether a joint turns, and its axis in its own frame."""
    kind = joint.shortname().removeprefix("JointModel")
    axis = AXES[kind[1]] if len(kind) == 2 else joint.extract().axis
    return kind[0] == "R", np.asarray(axis, dtype=float)


def rotation(axis: np.ndarray, angle: Any) -> Any:
    """Rodrigues' formula."""
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return ca.sparsify(ca.DM(np.eye(3))) + ca.DM(k) * ca.sin(angle) + ca.DM(k @ k) * (1 - ca.cos(angle))


def rnea(model: pin.Model, q: Any, v: Any, a: Any) -> Any:
    """Torques of all joints, damping included (nv,)."""
    motion: list[tuple[Any, ...]] = [(ca.DM(3, 1), ca.DM(3, 1), ca.DM(3, 1), ca.DM(-model.gravity.linear))]
    places: list[tuple[Any, ...]] = [()]
    forces: list[list[Any]] = [[ca.DM(3, 1), ca.DM(3, 1)]]
    for i in range(1, model.njoints):
        turns, axis = axis_of(model.joints[i])
        place, s = model.jointPlacements[i], ca.sparsify(ca.DM(axis))
        turn = ca.sparsify(ca.DM(place.rotation))
        at = ca.DM(place.translation)
        if turns:
            turn = turn @ rotation(axis, q[i - 1])
        else:
            at = at + turn @ s * q[i - 1]
        places.append((turn, at))
        w, linear, dw, dlinear = motion[model.parents[i]]
        linear, dlinear = turn.T @ (linear + ca.cross(w, at)), turn.T @ (dlinear + ca.cross(dw, at))
        w, dw = turn.T @ w, turn.T @ dw
        rate = s * v[i - 1]
        if turns:
            w = w + rate
            dw, dlinear = dw + s * a[i - 1] + ca.cross(w, rate), dlinear + ca.cross(linear, rate)
        else:
            linear = linear + rate
            dlinear = dlinear + s * a[i - 1] + ca.cross(w, rate)
        motion.append((w, linear, dw, dlinear))
        body = model.inertias[i]
        lever, inertia = ca.sparsify(ca.DM(body.lever)), ca.sparsify(ca.DM(body.inertia))
        p = body.mass * (linear + ca.cross(w, lever))
        f = body.mass * (dlinear + ca.cross(dw, lever))
        turned = inertia @ dw + ca.cross(lever, f) + ca.cross(w, inertia @ w + ca.cross(lever, p)) + ca.cross(linear, p)
        forces.append([f + ca.cross(w, p), turned])
    tau = [0] * model.nv
    for i in reversed(range(1, model.njoints)):
        turns, axis = axis_of(model.joints[i])
        force, moment = forces[i]
        tau[i - 1] = ca.dot(ca.DM(axis), moment if turns else force) + model.damping[i - 1] * v[i - 1]
        turn, at = places[i]
        above = forces[model.parents[i]]
        above[0] = above[0] + turn @ force
        above[1] = above[1] + turn @ moment + ca.cross(at, turn @ force)
    return ca.vertcat(*tau)
