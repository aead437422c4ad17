"""A walk by robotraj: the same feet, footholds, heights and times, limits and cones as hard rows, least effort."""

from __future__ import annotations

import resource
import sys
import time
from dataclasses import dataclass, fields
from operator import attrgetter
from typing import Any

import numpy as np
import pinocchio as pin
from models import robot_of
from walks import WALKS, Walk

import robotraj as rt

INTERVALS = {"solo12": (1, 6), "talos_legs": (2, 7)}
"""Intervals of a stance on all feet and of a swing."""
FROM_REST = {"solo12": [0.0, 0.2, 0.38, 0.5, 0.62, 0.8, 1.0]}
"""Knots of a swing; on equal intervals a foot is 1 to 3 mm below its parabola between the points, halfway."""
SAMPLES = 9
TOUCH = 1e-4
CALM = 0.3
POSTURES = {
    "standing": [0.0, 0.0, 0.235, 0.0, 0.0, 0.0, 1.0, 0.1, 0.8, -1.6, -0.1, 0.8, -1.6, 0.1, -0.8, 1.6, -0.1, -0.8, 1.6],
    "half_sitting": [0.0, 0.0, 1.01927, 0.0, 0.0, 0.0, 1.0] + [0.0, 0.0, -0.411354, 0.859395, -0.448041, -0.001708] * 2,
}
"""Crocoddyl's reference configurations."""


@dataclass(frozen=True)
class Swing(rt.constraints.RequiredHeight):
    """The parabola of a swing foot between two places, a tenth of a millimetre lower than ``rt.constraints.SwingApex``.

    At both ends the phases before and after also require that the foot is on the ground.
    """

    apex: float
    start: float
    end: float

    def heights(self, point: Any, position: Any) -> dict[str, Any]:
        """Ground and parabola [m]."""
        progress = (position[0] - self.start) / (self.end - self.start)
        return {"ground": -TOUCH, "apex": 4.0 * self.apex * progress * (1.0 - progress) - TOUCH}


def periodic(walk: Walk, robot: rt.Robot) -> tuple[rt.Problem, list[rt.Mesh]]:
    """Half a stride of a periodic gait by ``rt.gait``, with the same steps, heights and times."""
    swings = [entry for entry in walk.swings if entry is not None]
    swinging = len(swings) // 2 * walk.swing * walk.dt
    one = walk.support * walk.dt + swinging
    given = {"step_length": 0.5 * walk.length, "duration": one, "clearance": walk.height, "feet": list(walk.feet)}
    given["objective"] = objective_of(walk, robot)
    given["contact"] = lambda foot: foot_of(walk, foot)
    everyone = walk.support * walk.dt / one
    if walk.sole is not None:
        problem = rt.gait.walk(robot, double_support=everyone, **given)
    elif len(swings[0][0]) == 1:
        problem = rt.gait.crawl(robot, full_support=everyone, **given)
    else:
        problem = rt.gait.trot(robot, **given)
    stance, swing = INTERVALS[walk.robot]
    return problem, [rt.Mesh(stance if len(p.contacts) == len(walk.feet) else swing) for p in problem.phases]


def foot_of(walk: Walk, frame: str) -> rt.contacts.Contact:
    """Return the contact of a foot."""
    if walk.sole is None:
        return rt.PointContact(frame, friction=walk.friction)
    return rt.FlatFoot(frame, *walk.sole, friction=walk.friction)


def standing(walk: Walk, robot: rt.Robot) -> np.ndarray:
    """Crocoddyl's posture, feet flat on z = 0."""
    q = np.array(POSTURES[walk.posture])
    data = robot.model.createData()
    if walk.sole is not None:
        # Its ankles are 1e-5 and 2e-3 rad from level.
        for leg in (7, 13):
            q[leg + 4] = -q[leg + 2] - q[leg + 3]
            q[leg + 5] = -q[leg + 1]
    pin.framesForwardKinematics(robot.model, data, q)
    q[2] -= data.oMf[robot.frame(walk.feet[0])].translation[2]
    return q


def from_rest(walk: Walk, robot: rt.Robot) -> tuple[rt.Problem, list[rt.Mesh]]:
    """Crocoddyl's sequence, from standing still, phase by phase; a last short stance holds the footholds."""
    q = standing(walk, robot)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    places = {foot: data.oMf[robot.frame(foot)].translation.copy() for foot in walk.feet}
    gain = sum(share * len(feet) for feet, share, _ in walk.phases()) / len(walk.feet)
    objective = objective_of(walk, robot)
    upright = rt.gait.Upright()
    phases, meshes = [], []
    plan = [*walk.phases(), ((), 0.0, walk.dt)]
    for i, (swinging, length, duration) in enumerate(plan):
        stands = [foot for foot in walk.feet if foot not in swinging]
        rows = upright.constraints(robot, q, rt.terrain.Flat())
        for foot in swinging:
            x = float(places[foot][0])
            rows.append(rt.GroundClearance(foot, Swing(walk.height, x, x + length)))
        last = i == len(plan) - 1
        phases.append(
            rt.Phase(
                robot,
                duration,
                start=rt.State(q=q, v=0.0) if i == 0 else None,
                end=rt.State(q={"root_x": rt.between(float(q[0]) + 0.7 * gain, float(q[0]) + 1.3 * gain)})
                if last
                else None,
                objective=objective,
                constraints=rows,
                contacts=[foot_of(walk, foot) for foot in stands],
                # Feet that touched down are at their prescribed footholds; the others have not moved.
                parameters={
                    f"{foot}.{axis}": float(places[foot][k])
                    for foot in (plan[i - 1][0] if i else ())
                    for k, axis in enumerate("xy")
                },
                states=upright.states(robot),
                name=f"{i} {' and '.join(swinging) or 'all stand'}",
            )
        )
        stance, swing = INTERVALS[walk.robot]
        meshes.append(rt.Mesh(FROM_REST.get(walk.robot, swing) if swinging else 1 if last else stance))
        for foot in swinging:
            places[foot][0] += length
    links = [rt.links.Liftoff(i, i + 1) if not plan[i][0] else rt.Continuity(i, i + 1) for i in range(len(plan) - 1)]
    return rt.Problem(phases, links), meshes


@dataclass(frozen=True)
class Still:
    """A reference that does not move."""

    q: tuple[float, ...]
    v: tuple[float, ...]

    def __call__(self, t: Any) -> dict[str, Any]:
        """Return the posture at rest at any time."""
        return {"q": self.q, "v": self.v}


def objective_of(walk: Walk, robot: rt.Robot) -> rt.objectives.Objective:
    """Effort, posture with the weight of ``rt.gait``, and joint speeds: 0.3 s of speed counts as much as distance."""
    q = standing(walk, robot)
    data = robot.model.createData()
    height = float(pin.centerOfMass(robot.model, data, q)[2])
    worth = (0.2 * pin.computeTotalMass(robot.model) * 9.81 * height) ** 2
    joints = robot.joint_names[-robot.nu :]
    still = Still(tuple(q.tolist()), (0.0,) * robot.nv)
    calm = rt.objectives.Tracking(still, q=dict.fromkeys(joints, 1.0), v=dict.fromkeys(joints, CALM**2))
    return (1.0 / worth) * rt.Effort() + calm


CLOCK: list[float] = []
"""Processor seconds inside the solver."""


ENGINES = {
    "native": ("Ipopt", "engines.Native"),
    "machine": ("Ipopt", "engines.VirtualMachine"),
    "compiled": ("Ipopt", "engines.Compiled"),
    "interior-point": ("InteriorPoint", "engines.Native"),
    "interior-point-compiled": ("InteriorPoint", "engines.Compiled"),
}
"""Names of the solver and of what evaluates the point functions."""


def value(name: str, **settings: Any) -> Any:
    """Make an object of robotraj by name; exit where the name does not exist."""
    try:
        return attrgetter(name)(rt)(**settings)
    except AttributeError as error:
        raise SystemExit(f"cannot: this robotraj has no rt.{name}") from error


def clocked(solver: rt.Ipopt) -> rt.Ipopt:
    """Record a solver's processor seconds, which do not depend on the machine's load."""

    class Clocked(type(solver)):  # type: ignore[misc]
        def solve(self, nlp: rt.transcription.Nlp, *given: Any, **named: Any) -> Any:
            """Solve and note the time."""
            if isinstance(self, rt.Ipopt):
                # Assembling the functions that IPOPT calls is building the problem.
                _ = nlp.functions
            began = time.process_time()
            outcome = super().solve(nlp, *given, **named)
            CLOCK.append(time.process_time() - began)
            return outcome

    return Clocked(**{field.name: getattr(solver, field.name) for field in fields(solver)})


def samples(walk: Walk, solution: rt.Solution) -> dict[str, np.ndarray]:
    """Each interval's own polynomials."""
    rows: dict[str, list[Any]] = {name: [] for name in ("t", "q", "v", "a", "tau", "force", "stands")}
    for phase, found in zip(solution.problem.phases, solution.phases, strict=True):
        labels = {contact.frame: contact.label for contact in phase.contacts}
        for begin, end in zip(found.knots[:-1], found.knots[1:], strict=True):
            inside = 1e-9 * (end - begin)
            t = np.linspace(begin + inside, end - inside, SAMPLES)
            sample = found.at(t)
            force = np.zeros((SAMPLES, len(walk.feet), 6))
            for i, foot in enumerate(walk.feet):
                if foot in labels:
                    one = sample.forces[labels[foot]]
                    force[:, i, : one.shape[1]] = one
            for name, value in zip(rows, (t, sample.q, sample.v, sample.a, sample.tau, force), strict=False):
                rows[name].append(value)
            rows["stands"].append([foot in labels for foot in walk.feet])
    return {name: np.array(value) for name, value in rows.items()}


def main() -> None:
    """Solve and write samples of the plan."""
    walk, kind = WALKS[sys.argv[1]], sys.argv[3]
    robot = robot_of(walk.robot)
    problem, meshes = (periodic if kind == "periodic" else from_rest)(walk, robot)
    chosen, engine = ENGINES[sys.argv[4] if len(sys.argv) > 4 else "native"]
    # One thread, as Crocoddyl has; to a millionth, a thousandth of what the mesh leaves between its knots; for IPOPT a
    # barrier that leaves a guess on its feet where it is.
    settings = {"threads": 1} if chosen == "InteriorPoint" else {"initial_barrier": 1e-3}
    solver = clocked(value(chosen, max_iterations=300, tolerance=1e-6, **settings))
    solution = rt.plan(problem, meshes, solver=solver, engine=value(engine), check=False, progress=False)
    figures = {
        "solve": solution.times["solve"],
        "worked": sum(CLOCK),
        "success": solution.success,
        "iterations": solution.iterations,
        "nodes": sum(len(mesh.knots) - 1 for mesh in meshes),
        "objective": solution.objective,
        "ended": time.time(),
        "total worked": time.process_time(),
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    print(solution, solution.times, *solution.violations(), sep="\n")
    np.savez(sys.argv[2], **figures, **samples(walk, solution))


if __name__ == "__main__":
    main()
