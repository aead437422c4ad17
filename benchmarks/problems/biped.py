"""Kelly's five-link biped: one periodic step over a heel strike, as a System whose accelerations are algebraic.

Links: stance tibia, stance femur, torso, swing femur, swing tibia; q are absolute angles, 0 upright, counter-clockwise.
The residuals are the angular momentum balances about the ankle, the knees and the hip. A step ends with the heel
strike, which keeps angular momentum about the same points, and the legs change places.
Source: Kelly, SIAM Review 59 (2017), section 8 and appendix E.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

import robotraj as rt

from .case import Case

MASS = [3.2, 6.8, 20.0, 6.8, 3.2]  # kg
INERTIA = [0.93, 1.08, 2.22, 1.08, 0.93]  # about each centre of mass, kg m^2
LENGTH = [0.4, 0.4, 0.625, 0.4, 0.4]  # m
CENTRE = [0.128, 0.163, 0.2, 0.163, 0.128]  # of mass, from the upper end of the stance leg's links, m
GRAVITY = 9.81
STEP, TIME = 0.5, 0.7
Q = [f"q{i}" for i in range(1, 6)]
RATE = [f"dq{i}" for i in range(1, 6)]
ACCELERATION = [f"ddq{i}" for i in range(1, 6)]
TORQUE = [f"u{i}" for i in range(2, 6)]
FLIP = [4, 3, 2, 1, 0]
Plane = tuple[Any, Any]


class Chain:
    """Places, velocities and accelerations of joints and centres of mass, each (x, y), as linear forms of the links.

    Every point is a sum of c_i e_i over the links, e_i along link i; the same sums of de_i and dde_i are its rates.
    """

    def __init__(self, torso_from_hip: bool) -> None:
        one = np.eye(5) * LENGTH
        p1, p2 = one[0], one[0] + one[1]
        p4 = p2 + one[3]
        self.joints = [np.zeros(5), p1, p2, p2 + one[2], p4, p4 + one[4]]
        back = np.eye(5) * CENTRE
        torso = p2 + back[2] if torso_from_hip else p2 + one[2] - back[2]
        self.centres = [p1 - back[0], p2 - back[1], torso, p2 + back[3], p4 + back[4]]

    @staticmethod
    def directions(q: Sequence[Any], dq: Sequence[Any], ddq: Sequence[Any]) -> tuple[list[Plane], ...]:
        """Return unit vectors along the links with their first and second rates."""
        place, speed, acceleration = [], [], []
        for i, sign in enumerate([1, 1, 1, -1, -1]):
            s, c = sign * ca.sin(q[i]), sign * ca.cos(q[i])
            place.append((-s, c))
            speed.append((-c * dq[i], -s * dq[i]))
            acceleration.append((s * dq[i] ** 2 - c * ddq[i], -c * dq[i] ** 2 - s * ddq[i]))
        return place, speed, acceleration


def form(coefficients: Any, vectors: Sequence[Plane]) -> Plane:
    """Sum of coefficients times vectors."""
    used = [(c, v) for c, v in zip(coefficients, vectors, strict=True) if c]
    return sum(c * v[0] for c, v in used), sum(c * v[1] for c, v in used)


def cross(a: Plane, b: Plane) -> Any:
    """Component of a x b out of the plane."""
    return a[0] * b[1] - a[1] * b[0]


# Point about which a balance is taken, and the links it counts: ankle, knee, hip, hip, knee.
BALANCES = [(0, [0, 1, 2, 3, 4]), (1, [1, 2, 3, 4]), (2, [2, 3, 4]), (2, [3, 4]), (4, [4])]
# The same points and links before the heel strike, when the other leg stood.
STRIKES = [(5, [0, 1, 2, 3, 4]), (4, [0, 1, 2, 3]), (2, [0, 1, 2]), (2, [0, 1]), (1, [0])]


def system(chain: Chain) -> rt.System:
    """Equations of motion: qdot = dq, dqdot = ddq, five balances for ddq."""

    def rates(point: Any) -> list[Any]:
        return [point.x[name] for name in RATE] + [point.z[name] for name in ACCELERATION]

    def residual(point: Any) -> list[Any]:
        q, dq, ddq = (
            [part[n] for n in names] for part, names in ((point.x, Q), (point.x, RATE), (point.z, ACCELERATION))
        )
        place, _, acceleration = chain.directions(q, dq, ddq)
        rows = []
        for k, (about, links) in enumerate(BALANCES):
            row = 0 if k == 0 else point.u[TORQUE[k - 1]]
            for i in links:
                arm = form(chain.centres[i] - chain.joints[about], place)
                ax, ay = form(chain.centres[i], acceleration)
                row -= cross(arm, (MASS[i] * ax, MASS[i] * (ay + GRAVITY))) + INERTIA[i] * ddq[i]
            rows.append(row)
        return rows

    units = dict.fromkeys(Q, "rad") | dict.fromkeys(RATE, "rad/s") | dict.fromkeys(TORQUE, "N m")
    units |= dict.fromkeys(ACCELERATION, "rad/s^2")
    return rt.System(Q + RATE, TORQUE, rates, algebraic=ACCELERATION, residual=residual, units=units)


def heel_strike(chain: Chain) -> rt.links.Linkage:
    """Start the step as the last one ended: legs changed, angular momentum kept about new foot, knees and hip."""

    def momentum(q: Sequence[Any], dq: Sequence[Any], about: int, links: Sequence[int]) -> Any:
        place, speed, _ = chain.directions(q, dq, [0.0] * 5)
        return sum(
            MASS[i] * cross(form(chain.centres[i] - chain.joints[about], place), form(chain.centres[i], speed))
            + INERTIA[i] * dq[i]
            for i in links
        )

    def rows(step: Any) -> list[Any]:
        (q0, dq0), (q1, dq1) = (
            ([end.x[name] for name in Q], [end.x[name] for name in RATE]) for end in (step.start, step.end)
        )
        pose = [q0[i] - q1[FLIP[i]] for i in range(5)]
        kept = [
            momentum(q0, dq0, *after) - momentum(q1, dq1, *before)
            for after, before in zip(BALANCES, STRIKES, strict=True)
        ]
        return pose + kept

    return rt.links.Linkage((0,), rows, name="heel strike")


def biped(torso_from_hip: bool) -> Case:
    """Take one step; the torso's mass lies 0.2 m below the shoulder (Kelly's code) or above the hip (his table)."""
    chain = Chain(torso_from_hip)

    def foot(point: Any) -> Plane:
        place, _, _ = chain.directions([point.x[name] for name in Q], [0.0] * 5, [0.0] * 5)
        return form(chain.joints[5], place)

    def climb(point: Any) -> Any:
        _, speed, _ = chain.directions([point.x[n] for n in Q], [point.x[n] for n in RATE], [0.0] * 5)
        return form(chain.joints[5], speed)[1]

    def knees(point: Any) -> list[Any]:
        return [point.x["q2"] - point.x["q1"], point.x["q4"] - point.x["q5"]]

    first = np.array([-0.3, 0.7, 0.0, -0.5, -0.6])
    last = first[FLIP]
    rate = list((last - first) / TIME)
    step = rt.Phase(
        system(chain),
        TIME,
        objective=rt.Lagrange(lambda point: sum(point.u[name] ** 2 for name in TORQUE)),
        constraints=[
            rt.AtEnd(rt.PathConstraint(foot, [STEP, 0], [STEP, 0], name="foot", unit="m")),
            rt.AtStart(rt.PathConstraint(climb, lower=0, name="foot lifts", unit="m/s")),
            rt.AtEnd(rt.PathConstraint(climb, upper=0, name="foot falls", unit="m/s")),
            rt.PathConstraint(knees, lower=0, name="knee", unit="rad"),
        ],
        states=dict.fromkeys(Q, rt.between(-np.pi / 2, np.pi / 2)) | dict.fromkeys(RATE, rt.between(-10, 10)),
        controls=dict.fromkeys(TORQUE, rt.between(-100, 100)),
        name="step",
    )
    guess = rt.guess.Keyframes([0, 1], [rt.State([*first, *rate]), rt.State([*last, *rate])])
    exact, of = (390.7905, "table") if torso_from_hip else (469.6500, "code")
    return Case(
        f"biped, torso of the {of}",
        rt.Problem([step], [heel_strike(chain)]),
        guess,
        exact,
        2e-5,
        "fine meshes of an independent implementation",
    )
