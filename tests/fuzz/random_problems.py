"""Random problems that have a solution: a random motion is made first, and its ends and limits pose the problem."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
import pinocchio as pin

import robotraj as rt

S = rt.schemes
SCHEMES = (
    S.Trapezoidal(),
    S.HermiteSimpson(),
    S.HermiteSimpson(control=S.LinearControl()),
    S.FifthDegree(),
    S.LobattoIIIA(4),
    S.RadauIIA(2),
    S.RadauIIA(3),
    S.RadauIIA(4),
    S.GaussLegendre(1),
    S.GaussLegendre(2),
    S.GaussLegendre(3),
    S.CompressedHermiteSimpson(),
    S.MultipleShooting(),
    S.SingleShooting(),
)
ARMS = ("pendulum", "two_link_arm", "block", "z1", "ur5", "panda")
"""Robots with a motor at every joint."""
PASSIVE = ("cartpole", "acrobot")
"""Robots with passive joints."""
SYSTEMS = ("double_integrator", "oscillator", "van_der_pol", "duffing", "car", "quadrotor", "rod")
SUBJECTS = (*ARMS, *PASSIVE, *SYSTEMS)
SHOT = ("pendulum", "block", *SYSTEMS)
"""Subjects that are also solved by shooting."""
SLACK = 1.5
"""Ratio of a limit to what the motion needs."""
STEPS = 400


@dataclass(frozen=True, eq=False)
class Case:
    """A problem with its mesh; ``name`` is its subject."""

    name: str
    phase: rt.Phase
    mesh: rt.Mesh
    free: bool


@cache
def robot_of(name: str) -> rt.Robot:
    return rt.load(name)


@cache
def system_of(name: str) -> rt.System:
    """Return a System written with CasADi."""
    written = {
        "double_integrator": (["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]]),
        "oscillator": (["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"] - 4.0 * p.x["x"] - 0.1 * p.x["v"]]),
        "van_der_pol": (["x", "v"], ["u"], lambda p: [p.x["v"], (1 - p.x["x"] ** 2) * p.x["v"] - p.x["x"] + p.u["u"]]),
        "duffing": (["x", "v"], ["u"], lambda p: [p.x["v"], p.x["x"] - p.x["x"] ** 3 - 0.2 * p.x["v"] + p.u["u"]]),
        "car": (
            ["x", "y", "heading", "speed"],
            ["turn", "push"],
            lambda p: [
                p.x["speed"] * ca.cos(p.x["heading"]),
                p.x["speed"] * ca.sin(p.x["heading"]),
                p.u["turn"],
                p.u["push"],
            ],
        ),
        "quadrotor": (
            ["x", "z", "tilt", "vx", "vz", "rate"],
            ["left", "right"],
            lambda p: [
                p.x["vx"],
                p.x["vz"],
                p.x["rate"],
                -(p.u["left"] + p.u["right"]) * ca.sin(p.x["tilt"]),
                (p.u["left"] + p.u["right"]) * ca.cos(p.x["tilt"]) - 9.81,
                4.0 * (p.u["right"] - p.u["left"]),
            ],
        ),
        "rod": (["angle", "rate"], ["u"], lambda p: [p.x["rate"], p.u["u"] - 9.81 * ca.sin(p.x["angle"])]),
    }[name]
    return rt.System(written[0], written[1], written[2], name=name)


HOVER = {"quadrotor": 9.81 / 2}
"""Control about which a motion varies."""


def random_case(seed: int) -> Case:
    """Return the problem of a seed."""
    rng = np.random.default_rng([222, seed])
    name = SUBJECTS[rng.integers(len(SUBJECTS))]
    choice = SCHEMES if name in SHOT else SCHEMES[:-2]
    scheme = choice[rng.integers(len(choice))]
    make = _of_arm if name in ARMS else _of_passive if name in PASSIVE else _of_system
    phase, free = make(name, rng)
    fewest = 12 if scheme.order <= 2 else 6
    return Case(name, phase, rt.Mesh(int(rng.integers(fewest, 2 * fewest)), scheme), free)


def _duration(rng: np.random.Generator, seconds: float) -> tuple[float | tuple[float, float], bool]:
    if rng.random() < 0.4:
        return (0.6 * seconds, 2.0 * seconds), True
    return seconds, False


def _of_arm(name: str, rng: np.random.Generator) -> tuple[rt.Phase, bool]:
    """A polynomial of least jerk between two configurations, and the torques of its inverse dynamics."""
    robot = robot_of(name)
    low, high = (np.clip(b, -2.0, 2.0) for b in (robot.limits.position_lower, robot.limits.position_upper))
    first, last = (low + (high - low) * rng.uniform(0.25, 0.75, robot.nv) for _ in range(2))
    seconds = float(rng.uniform(0.6, 2.5))
    s = np.linspace(0, 1, STEPS)
    law, rate = 10 * s**3 - 15 * s**4 + 6 * s**5, (30 * s**2 - 60 * s**3 + 30 * s**4) / seconds
    push = (60 * s - 180 * s**2 + 120 * s**3) / seconds**2
    data, motion = robot.model.createData(), last - first
    tau = [
        pin.rnea(robot.model, data, first + motion * law[k], motion * rate[k], motion * push[k])
        + robot.damping * motion * rate[k]
        for k in range(STEPS)
    ]
    effort = SLACK * (np.abs(tau).max(axis=0) + robot.friction) + 1e-2
    speed = SLACK * np.abs(motion) * rate.max() + 1e-2
    limits = robot.limits.with_(
        effort=dict(zip(robot.velocity_names, effort, strict=True)),
        velocity=dict(zip(robot.velocity_names, speed, strict=True)),
    )
    duration, free = _duration(rng, seconds)
    objective = rt.Effort() + (float(rng.uniform(0.1, 10)) * rt.Duration() if free else 0.0 * rt.Duration())
    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    return rt.Phase(robot, duration, *ends, objective, limits=limits, name=name), free


def _wave(rng: np.random.Generator, count: int, size: float, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(0, seconds, STEPS + 1)
    parts = rng.uniform(-size, size, (count, 2)), rng.uniform(0, 2 * np.pi, count)
    return t, (parts[0][:, :1] + parts[0][:, 1:] * np.sin(2 * np.pi * t / seconds + parts[1][:, None])).T


def _simulated(rate: object, x: np.ndarray, t: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Runge-Kutta steps whose middles have the mean control."""
    found = [x]
    for k in range(STEPS):
        h, middle = t[k + 1] - t[k], 0.5 * (u[k] + u[k + 1])
        a = rate(x, u[k])
        b = rate(x + 0.5 * h * a, middle)
        c = rate(x + 0.5 * h * b, middle)
        d = rate(x + h * c, u[k + 1])
        x = x + h / 6 * (a + 2 * b + 2 * c + d)
        found.append(x)
    return np.array(found)


def _of_passive(name: str, rng: np.random.Generator) -> tuple[rt.Phase, bool]:
    """A simulated motion under a wave of torques; the last state is where it ends."""
    robot = robot_of(name)
    nv, data = robot.nv, robot.model.createData()
    seconds = float(rng.uniform(0.5, 1.5))
    t, u = _wave(rng, robot.nu, 3.0, seconds)
    actuation = np.asarray(robot.actuation, dtype=float)

    def rate(x: np.ndarray, tau: np.ndarray) -> np.ndarray:
        force = actuation @ tau - robot.damping * x[nv:]
        return np.concatenate([x[nv:], pin.aba(robot.model, data, x[:nv], x[nv:], force)])

    x = _simulated(rate, np.concatenate([rng.uniform(-0.5, 0.5, nv), np.zeros(nv)]), t, u)
    top = dict(zip(robot.actuated, SLACK * np.abs(u).max(axis=0) + 1e-2, strict=True))
    limits = robot.limits.with_(
        effort=top,
        velocity=float(2 * np.abs(x[:, nv:]).max() + 1),
        position=(-20.0, 20.0),
    )
    duration, free = _duration(rng, seconds)
    objective = rt.Effort() + (float(rng.uniform(0.1, 10)) * rt.Duration() if free else 0.0 * rt.Duration())
    ends = rt.State(q=x[0, :nv], v=x[0, nv:]), rt.State(q=x[-1, :nv], v=x[-1, nv:])
    return rt.Phase(robot, duration, *ends, objective, limits=limits, name=name), free


def _of_system(name: str, rng: np.random.Generator) -> tuple[rt.Phase, bool]:
    system = system_of(name)
    states, controls = ([v.name for v in group] for group in (system.states, system.controls))
    seconds = float(rng.uniform(0.5, 2.0))
    t, u = _wave(rng, len(controls), 1.0, seconds)
    u = u + HOVER.get(name, 0.0)
    x_symbol, u_symbol = ca.SX.sym("x", len(states)), ca.SX.sym("u", len(controls))
    point = type("Point", (), {"x": dict(zip(states, ca.vertsplit(x_symbol), strict=True)),
                               "u": dict(zip(controls, ca.vertsplit(u_symbol), strict=True))})  # fmt: skip
    flow = ca.Function("flow", [x_symbol, u_symbol], [ca.vertcat(*system.dynamics(point))])
    x = _simulated(lambda a, b: np.asarray(flow(a, b)).ravel(), rng.uniform(-0.5, 0.5, len(states)), t, u)
    middle, reach = 0.5 * (x.max(axis=0) + x.min(axis=0)), SLACK * np.ptp(x, axis=0) + 0.5
    top = SLACK * np.abs(u).max(axis=0)
    duration, free = _duration(rng, seconds)
    effort = rt.Lagrange(lambda p: sum(p.u[c] ** 2 for c in controls))
    objective = effort + float(rng.uniform(0.1, 10)) * rt.Duration() if free else effort
    # Some controls, such as a flow or a temperature, are never zero.
    bottom = u.min(axis=0) - 0.1 * top if rng.uniform() < 0.3 else -top
    phase = rt.Phase(
        system,
        duration,
        rt.State(dict(zip(states, x[0], strict=True))),
        rt.State(dict(zip(states, x[-1], strict=True))),
        objective,
        states={n: rt.between(m - r, m + r) for n, m, r in zip(states, middle, reach, strict=True)},
        controls={n: rt.between(low, high) for n, low, high in zip(controls, bottom, top, strict=True)},
        name=name,
    )
    return phase, free
