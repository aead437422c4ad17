"""Joints that follow others, as a change of coordinates of the independent joints' functions.

With all joints at q_all = S_q q + s, v_all = S v and a_all = S a, the equations of motion are M' a + h' = tau with
M' = S' M S and h' = S' h. Pinocchio's own algorithms for mimic joints are not used here.
Source: Featherstone, Rigid Body Dynamics Algorithms (2008), sections 3.2 and 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.errors import InputError

_Numbers = npt.NDArray[np.float64]


class AllJoints(NamedTuple):
    """Positions and velocities of all joints as affine functions of those of the independent ones.

    Attributes
    ----------
    places : ndarray (all nq, nq)
        S_q.
    offsets : ndarray (all nq,)
        s [rad, m].
    rates : ndarray (all nv, nv)
        S.
    """

    places: _Numbers
    offsets: _Numbers
    rates: _Numbers


def coordinates(model: pin.Model) -> AllJoints:
    """Return the coordinates of all joints; of a model without followers these are its own.

    Raises
    ------
    InputError
        A follower's position is not one number, as of a joint with cosine and sine.
    """
    places, offsets, rates = [], [], []
    q, v = np.eye(model.nq), np.eye(model.nv)
    for i in range(1, model.njoints):
        joint = model.joints[i]
        if joint.nv:
            places.append(q[joint.idx_q : joint.idx_q + joint.nq])
            rates.append(v[joint.idx_v : joint.idx_v + joint.nv])
            offsets.append(np.zeros(joint.nq))
            continue
        follower = joint.extract()
        if model.nqs[next(k for k in range(1, i) if model.joints[k].idx_v == joint.idx_v)] != 1:
            raise InputError(
                f"Joint {model.names[i]!r} follows a joint whose position is a cosine and a sine; its dynamics are not "
                "supported. Make both revolute joints with limits."
            )
        places.append(follower.scaling * q[joint.idx_q, None])
        rates.append(follower.scaling * v[joint.idx_v, None])
        offsets.append(np.full(1, follower.offset))
    return AllJoints(
        np.concatenate([*places, np.zeros((0, model.nq))]),
        np.concatenate([*offsets, np.zeros(0)]),
        np.concatenate([*rates, np.zeros((0, model.nv))]),
    )


def axis_of(model: pin.Model, i: int) -> _Numbers:
    """Return the motion (6,) of a follower at unit rate of its own, linear part first."""
    joint = model.joints[i]
    data = joint.createData()
    joint.calc(data, pin.neutral(model))
    return np.asarray(np.array(data.S).reshape(6) / joint.extract().scaling)


def in_coordinates(model: pin.Model, algorithm: str, of_all: ca.Function, bias: ca.Function | None) -> ca.Function:
    """Return the function of a model with followers from that of its joints as independent ones.

    Parameters
    ----------
    model : pinocchio.Model
    algorithm : str
        Name of the function.
    of_all : casadi.Function
        The function of all joints; of the mass matrix in place of forward dynamics.
    bias : casadi.Function, optional
        Inverse dynamics of all joints, which forward dynamics needs.
    """
    places, offsets, rates = coordinates(model)
    S, position = ca.sparsify(ca.DM(rates)), ca.sparsify(ca.DM(places))
    own_q, own_v = (_independent(matrix) for matrix in (places, rates))
    whole = of_all if bias is None else bias
    given = {name: ca.SX.sym(name, *_own_size(model, name, whole)) for name in whole.name_in()}
    if bias is not None:
        given = {"q": given["q"], "v": given["v"], "tau": given.pop("a"), **given}
        given = {name: given[name] for name in ("q", "v", "tau", *whole.name_in()[3:])}
    everywhere = {
        name: ca.mtimes(position, value) + offsets
        if name in ("q", "q0", "q1")
        else ca.mtimes(S, value)
        if name in ("v", "a", "dv")
        else value
        for name, value in given.items()
        if name != "tau"
    }
    if bias is not None:
        further = {name: everywhere[name] for name in whole.name_in()[3:]}
        still = ca.SX.zeros(len(offsets) and rates.shape[0])
        h = bias.call({"q": everywhere["q"], "v": everywhere["v"], "a": still, **further})["tau"]
        design = {name: further[name] for name in of_all.name_in() if name in further}
        M = of_all.call({"q": everywhere["q"], **design})["M"]
        D, factor, order = ca.ldl(ca.mtimes(S.T, ca.mtimes(M, S)))
        a = ca.ldl_solve(given["tau"] - ca.mtimes(S.T, h), D, factor, order)
        return ca.Function(algorithm, list(given.values()), [a], list(given), ["a"])
    found = of_all.call(everywhere)
    for name, value in found.items():
        if name in ("tau", "nle", "g"):
            found[name] = ca.mtimes(S.T, value)
        elif name == "M":
            found[name] = ca.mtimes(S.T, ca.mtimes(value, S))
        elif name == "J":
            found[name] = ca.mtimes(value, S)
        elif name in ("q1", "qdot"):
            found[name] = value[own_q]
        elif name == "dv":
            found[name] = value[own_v]
    names = of_all.name_out()
    return ca.Function(algorithm, list(given.values()), [found[name] for name in names], list(given), names)


def _own_size(model: pin.Model, name: str, whole: ca.Function) -> tuple[int, int]:
    rows = {"q": model.nq, "q0": model.nq, "q1": model.nq, "v": model.nv, "a": model.nv, "dv": model.nv}
    size: tuple[int, int] = (rows[name], 1) if name in rows else whole.size_in(name)
    return size


def _independent(matrix: _Numbers) -> list[int]:
    """Return the row of all joints' coordinates that equals each independent one."""
    return [int(np.flatnonzero((matrix == unit).all(axis=1))[0]) for unit in np.eye(matrix.shape[1])]
