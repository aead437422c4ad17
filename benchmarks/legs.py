"""IPOPT and our interior-point method on the same NLPs of legged robots, one after the other in one process.

python benchmarks/legs.py                 all of them; prints iterations, processor seconds of the solve and optima
python benchmarks/legs.py trot stairs     some of them
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

import robotraj as rt
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.transcription.nlp import Nlp

HERE = Path(__file__).resolve().parent
FOURTH = rt.schemes.LobattoIIIA(4)
Case = tuple[Any, ...]
"""Problem, mesh and, where there is one, a guess."""
LIMIT = 60.0
"""Wall-clock seconds of one solve."""


@dataclass(frozen=True)
class Keep(Solver):
    """Keeps the NLP instead of solving it."""

    kept: list[Nlp] = field(default_factory=list)

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """End the plan."""
        self.kept.append(nlp)
        raise StopIteration


def nlp_of(case: Case, engine: Any) -> Nlp:
    """Transcribe a case."""
    problem, mesh, *guess = case
    keep = Keep()
    rounds = rt.interval_limits.ConstraintGeneration(rounds=0)
    with suppress(StopIteration):
        rt.plan(problem, mesh, *guess, solver=keep, engine=engine, interval_limits=rounds)
    return keep.kept[0]


def _calm(robot: rt.Robot, contact: Any, weight: float, feet: Sequence[str] | None = None) -> Any:
    posture = rt.gait.stand(robot, feet, contact) if feet else rt.gait.stand(robot, contact=contact)
    return rt.gait.gait_objective(robot, posture) + weight * rt.Lagrange(lambda point: ca.sumsqr(point.a[6:]))


def _small(name: str) -> rt.Robot:
    limits = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}
    return rt.load(name, root="floating", limits=limits)


def _trot(length: float, duration: float) -> Case:
    robot, foot = _small("solo12"), partial(rt.PointContact, friction=0.5)
    chosen = {"clearance": 0.04, "contact": foot, "objective": _calm(robot, foot, 1e-5)}
    return rt.gait.trot(robot, step_length=length, duration=duration, **chosen), rt.Mesh(5, FOURTH)


def _jump() -> Case:
    robot, foot = _small("solo12"), partial(rt.PointContact, friction=0.5)
    loaded = partial(foot, cone=rt.contacts.Linearised(4), normal_force=(0.5, 40.0))
    chosen = {"push": 0.25, "land": 0.25, "contact": loaded, "objective": _calm(robot, foot, 1e-4)}
    problem = rt.gait.jump(robot, length=0.1, height=0.08, **chosen)
    return problem, [rt.Mesh(n, rt.HermiteSimpson()) for n in (14, 12, 12)]


def _crawl(**chosen: Any) -> Case:
    robot = rt.load("solo12", root="floating", limits={"velocity": 30.0, "effort": 3.0})
    return rt.gait.crawl(robot, step_length=0.05, **chosen), rt.Mesh(5, FOURTH)


def _bolt(mesh: rt.Mesh) -> Case:
    robot, foot = _small("bolt"), partial(rt.PointContact, friction=0.6)
    chosen = {"clearance": 0.03, "contact": foot, "objective": _calm(robot, foot, 1e-5)}
    return rt.gait.walk(robot, step_length=0.06, duration=0.2, **chosen), mesh


def _five_link(name: str, clearance: float) -> Case:
    robot, foot = rt.load(name, root="planar"), rt.PointContact("left_foot", friction=2.0)
    step = rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=clearance, upright=None)
    return step, rt.Mesh(12, FOURTH)


def _run() -> Case:
    robot = rt.load("five_link", root="planar")
    written = rt.gait.run(robot, step_length=1.0, duration=0.4, contact=rt.PointContact("left_foot", friction=0.8))
    phases = [replace(phase, duration=(0.05, 0.35)) for phase in written.phases]
    pace = rt.links.Linkage([0, 1], lambda a, b: b.end.t - a.start.t, 0.4, 0.4, name="time of a step", unit="s")
    mesh = rt.Mesh(12, rt.HermiteSimpson(control=rt.schemes.LinearControl()))
    return rt.Problem(phases, [*written.links, pace]), mesh


def _talos_legs() -> Case:
    robot, feet = rt.load("talos_legs", root="floating"), ("left_sole_link", "right_sole_link")
    sole = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.6)
    chosen = {"double_support": 0.2, "clearance": 0.04, "repeat": rt.Periodic()}
    objective = _calm(robot, sole, 0.3, feet)
    step = rt.gait.walk(robot, feet=feet, contact=sole, step_length=0.2, duration=0.8, objective=objective, **chosen)
    return step, [rt.Mesh(n, FOURTH) for n in (5, 7, 5, 7)]


def _example(name: str, until: str, result: Callable[[dict[str, Any]], Case]) -> Case:
    """Run an example up to its plan."""
    names: dict[str, Any] = {}
    source = next((HERE.parent / "examples").glob(f"{name}*.py")).read_text().split(until)[0]
    exec(source, names)
    return result(names)


def _compass(descent: float, length: Any) -> Case:
    walker = rt.load("compass_walker", root="planar")
    motor = rt.PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor", unit="N m")
    ground = rt.terrain.Slope(-np.tan(descent))

    def height(point: Any) -> Any:
        foot = point.frame("right_foot").position
        return foot[2] - ground.height(foot[0], foot[1])

    landing = rt.AtEnd(rt.PathConstraint(height, 0, 0, name="foot on the ground"))
    step = rt.Phase(
        walker,
        duration=(0.6, 1.2),
        start=rt.State(q={"root_pitch": 0}),
        contacts=[rt.PointContact("left_foot", ground=ground)],
        parameters={"left_foot.x": 0},
        constraints=[motor, landing],
        objective=rt.Effort(),
    )
    legs = {"left_hip": "right_hip", "left_foot": "right_foot"}
    mirror = rt.Mirror(legs, displacement={"q.root_x": length, "q.root_z": None})
    return rt.Problem([step], [rt.Touchdown(0, 0, repeat=mirror)]), rt.Mesh(8, FOURTH)


def _whole_talos() -> Case:
    sys.path.insert(0, str(HERE))
    import talos

    return talos.walk(rt.load("talos", root="floating")), rt.Mesh(5)


CASES: dict[str, Callable[[], Case]] = {
    "trot": lambda: _trot(0.06, 0.2),
    "long trot": lambda: _trot(0.12, 0.25),
    "jump": _jump,
    "crawl": lambda: _crawl(duration=0.5),
    "crawl, full support": lambda: _crawl(duration=(0.5, 1.0), full_support=0.2),
    "bolt": lambda: _bolt(rt.Mesh(6, FOURTH)),
    "bolt, Hermite-Simpson": lambda: _bolt(rt.Mesh(12, rt.HermiteSimpson())),
    "five_link": lambda: _five_link("five_link", 0.0),
    "five_link, lifted": lambda: _five_link("five_link", 0.1),
    "five_link_table": lambda: _five_link("five_link_table", 0.0),
    "run": _run,
    "talos_legs": _talos_legs,
    "compass": lambda: _compass(0.0, 0.4),
    "compass downhill": lambda: _compass(0.0525, rt.between(0.3, 0.8)),
    "stairs": lambda: _example("16", "coarse =", lambda names: (names["climb"], rt.Mesh(6))),
    "stairs, fine": lambda: _example("16", "coarse =", lambda names: (names["climb"], rt.Mesh(12, FOURTH))),
    "talos": _whole_talos,
}


def main() -> None:
    """Solve each with both and print a line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", choices=[[], *CASES])
    parser.add_argument("--starts", type=int, default=1, help="perturbed guesses of each, the first one as it is")
    chosen = parser.parse_args()
    solvers = {
        "IPOPT": rt.Ipopt(time_limit=LIMIT),
        "ours": rt.InteriorPoint(time_limit=LIMIT, threads=1, fallback=None),
    }
    print("| problem | start | solver | status | iterations | seconds | objective |")
    print("|---|---|---|---|---|---|---|")
    for name in chosen.names or CASES:
        nlp = nlp_of(CASES[name](), rt.engines.Native())
        noise = np.random.default_rng(0)
        for start in range(chosen.starts):
            moved = nlp.guess + (1e-3 if start else 0.0) * nlp.scale * noise.standard_normal(len(nlp.guess))
            here = replace(nlp, guess=moved)
            for label, solver in solvers.items():
                began = time.process_time()
                found = solver.solve(here)
                seconds = time.process_time() - began
                row = name, start, label, found.status.value, found.iterations, f"{seconds:.3f}"
                print("|", *(f"{each} |" for each in row), f"{nlp.objective(found.w):.9g} |", flush=True)


if __name__ == "__main__":
    main()
