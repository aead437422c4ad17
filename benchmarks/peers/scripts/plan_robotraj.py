"""A task with robotraj: PEERS_SOLVER, PEERS_ENGINE and PEERS_INTERVAL_LIMITS name values that rt.plan is given.

PEERS_STARTS is a number of starts of rt.multistart, all in this process; 1 by default, rt.plan itself.
PEERS_MESH=Chebyshev selects a mesh for the minimum time of an arm. PEERS_MESH=open leaves the mesh to robotraj, which
then proves the plan.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from operator import attrgetter
from typing import Any

import numpy as np
from report import Clock, Report, inside, requested_task, urdf
from tasks import Task

import robotraj as rt

USED = (
    rt.Phase,
    rt.State,
    rt.Effort,
    rt.Duration,
    rt.Mesh,
    rt.HermiteSimpson,
    rt.schemes.RadauIIA,
    rt.guess.StraightLine,
    rt.load,
    rt.plan,
)
"""Names are imported on first access; this access counts them among the imports."""


AWAY = -0.05
"""How far every joint of another goal is [rad, m]."""
SETTINGS: dict[str, dict[str, Any]] = {
    "InteriorPoint": {"threads": 1},
    "interval_limits.BernsteinBounds": {"controls": True},
}
"""One thread, as for all other tools; limits of torques are bounded on whole intervals, like those of speeds."""
SEED = 0
"""Seed of the starts; benchmarks/starts.py has the results of others."""


def value(name: str) -> Any:
    """Make a solver, an engine or a method for limits from its name below ``rt``.

    Raises
    ------
    SystemExit
        The name does not exist.
    """
    try:
        return attrgetter(name)(rt)(**SETTINGS.get(name, {}))
    except AttributeError as error:
        raise SystemExit(f"cannot: this robotraj has no rt.{name}") from error


def phase_of(task: Task) -> rt.Phase:
    """Pose the task in a user's three lines."""
    acrobot = task.urdf == "rods"
    return rt.Phase(
        rt.load(urdf(task), actuated=["elbow"]) if acrobot else rt.load(task.urdf),
        duration=task.duration,
        start=rt.State(q=task.start, v=0),
        end=rt.State(q=task.end, v=0),
        objective=rt.Effort() if task.objective == "effort" else rt.Duration(),
    )


def search(task: Task, mesh: rt.Mesh, starts: int, settings: dict[str, Any]) -> tuple[rt.Solution, int]:
    """Plan from many starts; give the best plan and the iterations of all of them."""
    settings = settings | {"solver": rt.InteriorPoint(fallback=None, **SETTINGS["InteriorPoint"])}
    with ThreadPoolExecutor(1) as here:
        guess = rt.guess.StraightLine(task.guess)
        found = rt.multistart(phase_of(task), starts, SEED, guess=guess, executor=here, mesh=mesh, **settings)
    return found.best, found.iterations


def solve_from_many(task: Task, starts: int, settings: dict[str, Any]) -> None:
    """Report the best of many starts; all that they take counts as solving."""
    mesh = rt.Mesh(task.intervals)
    with Clock() as first:
        best, iterations = search(task, mesh, starts, settings)
    report = Report((first.wall, first.processor), iterations, best.success, best.status.value)
    with Clock() as clock:
        search(task, mesh, starts, settings)
    again = {"again": clock.wall, "again cpu": clock.processor, "again solve": clock.wall}
    report.write(*curves_of(best), **again, **{"again solve cpu": clock.processor})


def curves_of(solution: rt.Solution) -> tuple[np.ndarray, ...]:
    """Sample times, positions, velocities and torques inside every interval."""
    part = solution.phases[0]
    t = inside(part.knots)
    samples = [part.at(times, interval=k) for k, times in enumerate(t)]
    return t, *(np.array([getattr(s, name) for s in samples]) for name in ("q", "v", "tau"))


def mesh_of(task: Task) -> rt.Mesh | None:
    """Return equal intervals of Hermite-Simpson, or twice as many of lower order that are dense at both ends."""
    if os.environ.get("PEERS_MESH") == "open":
        return None
    if os.environ.get("PEERS_MESH") == "Chebyshev":
        return rt.Mesh.chebyshev(2 * task.intervals, rt.schemes.RadauIIA(2))
    # A bang-bang force is constant within each interval, so that it cannot bulge over its limit.
    scheme = rt.HermiteSimpson(control=rt.schemes.ConstantControl()) if task.urdf == "block" else rt.HermiteSimpson()
    return rt.Mesh(task.intervals, scheme)


def solve(task: Task, settings: dict[str, Any]) -> None:
    """Plan, report; plan the same again and another goal in the same process."""
    mesh = mesh_of(task)

    def plan(problem: rt.Problem, guess: rt.guess.StraightLine | rt.Solution) -> rt.Solution:
        return rt.plan(problem, mesh, guess, check=False, progress=False, **settings)

    with Clock() as first:
        problem = rt.Problem([phase_of(task)])
        solution = plan(problem, rt.guess.StraightLine(task.guess))
    # The solver reports wall-clock seconds; the plan's ratio of processor to wall-clock time converts them.
    solving = solution.times["solve"]
    spent = solving * first.processor / first.wall
    report = Report((solving, spent), solution.iterations, solution.success, solution.status.value)
    with Clock() as clock:
        second = plan(rt.Problem([phase_of(task)]), rt.guess.StraightLine(task.guess))
    with Clock() as other:
        moved = plan(problem.with_(end=rt.State(q=np.add(task.end, AWAY), v=0)), solution)
    again = {
        "again": clock.wall,
        "again cpu": clock.processor,
        "again solve": second.times["solve"],
        "again solve cpu": second.times["solve"] * clock.processor / clock.wall,
    }
    if moved.success:
        again["moved cpu"] = other.processor
    report.write(*curves_of(solution), **again)


def main() -> None:
    """Read the environment and solve."""
    named = {what: os.environ.get(f"PEERS_{what.upper()}") for what in ("solver", "engine", "interval_limits")}
    settings = {what: value(name) for what, name in named.items() if name}
    starts = int(os.environ.get("PEERS_STARTS", "1"))
    if starts > 1:
        solve_from_many(requested_task(), starts, settings)
    else:
        solve(requested_task(), settings)


if __name__ == "__main__":
    main()
