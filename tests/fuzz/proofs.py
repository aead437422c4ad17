"""Problems whose answer is known from elsewhere: how often is a plan wrong whose proof holds?

Judges are closed forms in drawn units, a Riccati equation, IPOPT on three times the intervals, the inverse dynamics of
MuJoCo, coal on dense samples, optima of phases in the phase plane, and the same problem in SI units. Each kind draws a
problem, which is planned by default, and a judge of its solution.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import coal
import numpy as np
import pinocchio as pin
from drawn_robots import Judge, other_units
from joint_phases import JointPhases
from random_problems import random_case
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find

SECONDS = 20.0
"""Limit of the processor time of a plan [s]."""
WORSE = 3e-3
"""Relative excess over the known optimum that is wrong: the thresholds of objective and optimum together."""
BETTER = 1e-3
"""Relative gain over the known optimum that is wrong."""
LOAD = 1e-2
"""Difference of torques that is wrong, relative to the largest of the joint: twice that of the proof."""
DEPTH = 1e-4
"""Depth of an overlap that is wrong [m]."""
PLAIN = ("block", "pendulum", "cartpole", "two_link_arm", "double_integrator", "oscillator", "van_der_pol", "rod")
"""Subjects of random problems that are planned in a second or so."""


def mass() -> rt.System:
    """Return a mass of 1 kg with a force along a line."""
    return rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


def least_effort(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """Any ends in drawn units: J = 4 (3 d^2 - 3 d T (a + b) + T^2 (a^2 + a b + b^2)) / T^3."""
    length, T = 10.0 ** rng.uniform(-3, 3), 10.0 ** rng.uniform(-2, 2)
    d = length * rng.uniform(0.3, 2.0)
    a, b = rng.uniform(-1, 1, 2) * length / T
    phase = rt.Phase(
        mass(), T, rt.State([0, a]), rt.State([d, b]), rt.Lagrange(lambda point: point.u["u"] ** 2), name="mass"
    )
    return phase, optimum(4.0 * (3 * d**2 - 3 * d * T * (a + b) + T**2 * (a**2 + a * b + b**2)) / T**3)


def least_time(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """From rest to rest with |u| <= U and |v| <= V: 2 sqrt(d / U), or d / V + V / U where V is reached."""
    length, second = 10.0 ** rng.uniform(-3, 3), 10.0 ** rng.uniform(-2, 2)
    d, U = length * rng.uniform(0.5, 2.0), length / second**2 * rng.uniform(0.5, 2.0)
    V = np.sqrt(d * U) * rng.uniform(0.3, 1.5)
    T = 2.0 * np.sqrt(d / U) if d * U < V**2 else d / V + V / U
    limits = {"states": {"v": rt.between(-V, V)}, "controls": {"u": rt.between(-U, U)}}
    ends = rt.State([0, 0]), rt.State([d, 0])
    return rt.Phase(mass(), (0.2 * T, 20.0 * T), *ends, rt.Duration(), **limits, name="mass"), optimum(T)


def corridor(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """The problem of Bryson and Denham with x <= l <= T / 6 at unit speeds: J = 4 / (9 l)."""
    T = 10.0 ** rng.uniform(-2, 2)
    room = T * rng.uniform(0.02, 1.0 / 6.0)
    phase = rt.Phase(
        mass(),
        T,
        rt.State([0, 1]),
        rt.State([0, -1]),
        rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2),
        states={"x": rt.between(None, room)},
        name="corridor",
    )
    return phase, optimum(4.0 / (9.0 * room))


def quadratic(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """x' = a x + u, cost u^2 + q x^2 and w x(T)^2: P x0^2 with -P' = 2 a P - P^2 + q, P(T) = w."""
    a, q, w, T = rng.uniform(-2, 2), rng.uniform(0, 5), rng.uniform(0, 20), rng.uniform(0.3, 4.0)
    start = 10.0 ** rng.uniform(-1, 1)
    found = solve_ivp(lambda t, P: 2 * a * P - P**2 + q, (0.0, T), [w], rtol=1e-11, atol=1e-13)
    system = rt.System(["x"], ["u"], lambda point: [a * point.x["x"] + point.u["u"]])
    running = rt.Lagrange(lambda point: point.u["u"] ** 2 + q * point.x["x"] ** 2)
    cost = running + rt.Mayer(lambda first, last: w * last.x["x"] ** 2)
    phase = rt.Phase(system, T, rt.State([start]), None, cost, name="quadratic")
    return phase, optimum(float(found.y[0, -1]) * start**2)


def other_solver(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """A problem with a motion: IPOPT on three times the intervals, from the plan, finds no better one nearby."""
    case = random_case(int(rng.integers(10**9)))
    while case.name not in PLAIN:
        case = random_case(int(rng.integers(10**9)))

    def judge(solution: rt.Solution) -> str:
        (part,) = solution.phases
        mesh = rt.Mesh(min(3 * part.mesh.count, 150), rt.schemes.RadauIIA(3))
        other = rt.plan(case.phase, mesh, solution, rt.Ipopt(), check=False, progress=False, time_limit=2 * SECONDS)
        if not other.success or solution.objective <= other.objective * (1.0 + WORSE) + 1e-9:
            return ""
        return f"objective {solution.objective:.8g}, and IPOPT finds {other.objective:.8g} from there"

    return case.phase, judge


def inverse_dynamics(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """A reach or swing of a robot: its torques are those of MuJoCo."""
    import mujoco

    name = str(rng.choice(["pendulum", "two_link_arm"]))
    robot = rt.load(name)
    far = rng.uniform(0.2, 0.6, robot.nv)
    phase = rt.Phase(robot, 4.0, rt.State(q=0, v=0), rt.State(q=far, v=0), rt.Effort(), name=name)
    model = mujoco.MjModel.from_xml_path(str(find(name).urdf))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)

    def judge(solution: rt.Solution) -> str:
        sample = solution.at(np.linspace(0.0, solution.duration, 101)[1:-1])
        acting = np.zeros((len(sample.q), robot.nv))
        acting[:, [robot.velocity_names.index(joint) for joint in robot.actuated]] = sample.tau
        for i in range(len(acting)):
            data.qpos[:], data.qvel[:], data.qacc[:] = sample.q[i], sample.v[i], sample.a[i]
            mujoco.mj_inverse(model, data)
            acting[i] -= data.qfrc_inverse + robot.friction * np.sign(sample.v[i])
        size = np.abs(sample.tau).max() + 1e-9
        worst = float(np.sqrt(np.mean(acting**2, axis=0)).max() / size)
        return f"torques differ from MuJoCo's by {worst:.1e}" if worst > LOAD else ""

    return phase, judge


def free_way(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """A reach of an arm past balls: coal finds no overlap at 400 times."""
    robot = rt.load("z1")
    low, high = robot.limits.position_lower, robot.limits.position_upper
    first, last = (low + (high - low) * rng.uniform(0.35, 0.65, robot.nv) for _ in range(2))
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, 0.5 * (first + last))
    middle = data.oMi[robot.model.njoints - 1].translation
    balls = [(float(rng.uniform(0.02, 0.06)), middle + rng.normal(0.0, 0.12, 3)) for _ in range(2)]
    shapes = [rt.obstacles.Sphere(radius, position=tuple(place)) for radius, place in balls]
    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    phase = rt.Phase(robot, 3.0, *ends, rt.Effort(), constraints=[rt.CollisionFree(shapes)], name="z1 past balls")

    def judge(solution: rt.Solution) -> str:
        model, geometry = robot.model, robot.collision_model
        own, there = model.createData(), geometry.createData()
        worst = np.inf
        for q in solution.at(np.linspace(0.0, solution.duration, 400)).q:
            pin.updateGeometryPlacements(model, own, geometry, there, q)
            for shape, pose in zip(geometry.geometryObjects, there.oMg, strict=True):
                at = coal.Transform3s(pose.rotation, pose.translation)
                for radius, place in balls:
                    ball = coal.Sphere(radius), coal.Transform3s(np.eye(3), place)
                    request, found = coal.DistanceRequest(), coal.DistanceResult()
                    worst = min(worst, coal.distance(shape.geometry, at, *ball, request, found))
        return f"an overlap of {-worst:.1e} m" if worst < -DEPTH else ""

    return phase, judge


def phases(rng: np.random.Generator) -> tuple[rt.Problem, Judge]:
    """One joint in several phases, with states given between them: its least time is the sum of theirs."""
    drawn = JointPhases.drawn(rng)
    return drawn.problem, optimum(drawn.optimum)


def optimum(known: float) -> Judge:
    """Return the judge of a problem whose optimal objective is known."""

    def judge(solution: rt.Solution) -> str:
        ratio = solution.objective / known
        return "" if 1.0 - BETTER < ratio < 1.0 + WORSE else f"objective {solution.objective:.8g}, right {known:.8g}"

    return judge


KINDS: dict[str, tuple[Callable[[np.random.Generator], tuple[rt.Phase | rt.Problem, Judge]], float]] = {
    "least effort": (least_effort, 4),
    "least time": (least_time, 4),
    "corridor": (corridor, 3),
    "quadratic": (quadratic, 3),
    "other solver": (other_solver, 3),
    "inverse dynamics": (inverse_dynamics, 2),
    "free way": (free_way, 1),
    "phases": (phases, 2),
    "other units": (other_units, 2),
}
"""Kinds of problems with the weight that each is drawn by."""


@dataclass
class Tally:
    """Counts by kind, and a line for each proved plan that is wrong."""

    drawn: Counter[str] = field(default_factory=Counter)
    proved: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def attempt(self, seed: int) -> None:
        """Draw, plan and judge the problem of a seed."""
        rng = np.random.default_rng([44, seed])
        weights = np.array([weight for _, weight in KINDS.values()])
        kind = str(rng.choice(list(KINDS), p=weights / weights.sum()))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                phase, judge = KINDS[kind][0](rng)
            except rt.InputError:  # drawn ends or balls that cannot be
                return
            self.drawn[kind] += 1
            try:
                solution = rt.plan(phase, check=False, progress=False, time_limit=SECONDS)
            except rt.InputError:
                return
            if solution.proof is None or not solution.proof.holds:
                return
            self.proved[kind] += 1
            if fault := judge(solution):
                self.wrong.append(f"{kind} {seed}: {fault}")

    def __str__(self) -> str:
        rows = [f"{kind:18s} {self.drawn[kind]:6d} drawn {self.proved[kind]:6d} proved" for kind in self.drawn]
        proved = sum(self.proved.values())
        share = 100.0 * len(self.wrong) / max(proved, 1)
        return "\n".join([*rows, *self.wrong, f"{len(self.wrong)} of {proved} proved plans are wrong ({share:.2g} %)"])
