"""Point functions by CasADi's virtual machine, as compiled C and in our own module: ``python benchmarks/engines.py``.

Every task is posed once for each engine, and all are evaluated and solved in turn. Figures are medians of processor
time, so other work on the machine counts little. Libraries are compiled into an empty cache. Solves stop after a given
number of iterations. The first two engines take the same steps, to the last bit; the third computes the same
derivatives by other formulas, to 1e-9. Both are checked.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

import robotraj as rt

UR5 = (-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)
PANDA = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785), (1.5, 0.5, -0.5, -1.2, 0.6, 2.2, -0.8)


def arm(name: str, ends: Any, **more: Any) -> rt.Problem:
    robot = rt.load(name, **more)
    idle = [0.0] * (robot.nq - len(ends[0]))
    start, end = (rt.State(q=[*q, *idle], v=0) for q in ends)
    return rt.Problem([rt.Phase(robot, 1.0, start, end, rt.Effort())])


def trot() -> rt.Problem:
    return rt.gait.trot(rt.load("solo12", root="floating"), step_length=0.06, duration=0.2, clearance=0.04)


TASKS: dict[str, tuple[Callable[[], rt.Problem], int]] = {
    "ur5": (lambda: arm("ur5", UR5), 50),
    "panda": (
        lambda: arm("panda", PANDA, locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}),
        50,
    ),
    "solo12 trot": (trot, 12),
}
"""Problem and number of Hermite-Simpson intervals."""

FASTER = ("compiled", "native")


def seconds(action: Callable[[], Any]) -> float:
    """Processor time of this process [s]."""
    began = time.process_time()
    action()
    return time.process_time() - began


def in_turn(actions: dict[str, Callable[[], Any]], runs: int) -> dict[str, float]:
    """Median seconds of every action, all run once before any is run again."""
    taken: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(runs):
        for name, action in actions.items():
            taken[name].append(seconds(action))
    return {name: float(np.median(times)) for name, times in taken.items()}


class Evaluator:
    """Calls a function in place, as a solver does, without copies from and to Python."""

    def __init__(self, function: ca.Function, arguments: list[Any]) -> None:
        self._buffer, self.call = function.buffer()
        self._arguments = [np.atleast_1d(np.array(a, dtype=float)) for a in arguments]
        self._results = [np.zeros(function.nnz_out(i)) for i in range(function.n_out())]
        for i, argument in enumerate(self._arguments):
            self._buffer.set_arg(i, memoryview(argument))
        for i, result in enumerate(self._results):
            self._buffer.set_res(i, memoryview(result))

    def __call__(self) -> np.ndarray:
        """Return the results in order."""
        self.call()
        return np.concatenate(self._results)


def same(one: ca.DM, other: ca.DM) -> bool:
    """Whether two matrices are equal to 1e-9 of the largest entry, whatever their patterns."""
    return float(ca.norm_inf(ca.vec(one - other))) <= 1e-9 * float(ca.norm_inf(ca.vec(one)))


def points(
    nlps: dict[str, rt.transcription.Nlp], engines: dict[str, Any], w: np.ndarray, runs: int
) -> list[dict[str, float]]:
    """Time the functions of the first phase's points alone, as the compiled solver calls them [ms a point]."""
    calls: dict[str, dict[str, Callable[[], Any]]] = {}
    for name, nlp in nlps.items():
        block = nlp.blocks[0]
        made = engines[name].block(block.stage, block.count, True)
        v = np.ascontiguousarray(block.places(w * nlp.scale).T).ravel()
        c = np.ascontiguousarray(block.constants.T).ravel()
        m = np.random.default_rng(1).standard_normal(block.count * block.stage.outputs)
        arguments = {"values": (v, c), "jacobian": (v, c), "hessian": (v, c, m)}
        calls[name] = {what: partial(getattr(made, what), *given) for what, given in arguments.items()}
    count = next(iter(nlps.values())).blocks[0].count
    taken = (
        in_turn({e: each[what] for e, each in calls.items()}, 3 * runs) for what in ("values", "jacobian", "hessian")
    )
    # The output is in ms of all points, the table in us of one.
    return [{e: 1e3 * seconds / count for e, seconds in times.items()} for times in taken]


def measure(name: str, runs: int, iterations: int) -> str:
    make, intervals = TASKS[name]
    problem, mesh = make(), rt.Mesh(intervals)
    with tempfile.TemporaryDirectory() as folder:
        compiled = rt.engines.Compiled(cache=Path(folder) / "cache")
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        made = rt.planning.precompile(problem, mesh, engine=compiled)
        compiler = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        engines: dict[str, Any] = {
            "plain": rt.engines.VirtualMachine(),
            "compiled": compiled,
            "native": rt.engines.Native(),
        }
        nlps = {
            e: rt.transcription.transcribe(problem, mesh, rt.guess.default_guess(problem), engine=engine)
            for e, engine in engines.items()
        }
        w = nlps["plain"].guess / nlps["plain"].scale
        m = np.random.default_rng(0).standard_normal(len(nlps["plain"].rows))
        lines = points(nlps, engines, w, runs)
        for what in ("rows", "jacobian", "hessian"):
            more = (1.0, m) if what == "hessian" else ()
            evaluators = {e: Evaluator(getattr(n.functions, what), [w, [], *more]) for e, n in nlps.items()}
            calls: dict[str, Callable[[], Any]] = {e: evaluator.call for e, evaluator in evaluators.items()}
            first = {e: evaluator() for e, evaluator in evaluators.items()}
            assert np.array_equal(first["plain"], first["compiled"], equal_nan=True), f"{name}: {what} differ"
            results = {e: getattr(n.functions, what)(w, [], *more) for e, n in nlps.items()}
            last = {e: result[-1] if isinstance(result, tuple | list) else result for e, result in results.items()}
            assert same(last["plain"], last["native"]), f"{name}: {what} differ"
            lines.append(in_turn(calls, runs))
        outcomes: dict[str, Any] = {}
        solver = rt.Ipopt(max_iterations=iterations)
        solves = {e: (lambda e=e, n=n: outcomes.update({e: solver.solve(n)})) for e, n in nlps.items()}
        taken = in_turn(solves, max(3, runs // 3))
        assert np.array_equal(outcomes["plain"].w, outcomes["compiled"].w), f"{name}: the engines' steps differ"
        lines.append({e: seconds / outcomes[e].iterations for e, seconds in taken.items()})
    cells = [
        " / ".join([f"{1e3 * t['plain']:.3g}", *(f"{1e3 * t[e]:.3g} ({t['plain'] / t[e]:.1f}x)" for e in FASTER)])
        for t in lines
    ]
    return " | ".join([f"| {name}, {intervals}", *cells, f"{made.seconds:.1f} s ({compiler:.1f} s processor) |"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tasks", nargs="*", help=f"some of {', '.join(TASKS)}; all by default")
    parser.add_argument("--runs", type=int, default=9, help="evaluations of each engine; a third as many solves")
    parser.add_argument("--iterations", type=int, default=30, help="after which solves stop")
    parser.add_argument("--markdown", type=Path, help="where the table is written too")
    options = parser.parse_args()
    table = [
        "| task, intervals | a point's values [us] | its Jacobian [us] | its Hessian [us] "
        "| rows [ms] | Jacobian [ms] | Hessian [ms] | an iteration of IPOPT [ms] | compiling |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    print(*table, sep="\n")
    for name in options.tasks or TASKS:
        table.append(measure(name, options.runs, options.iterations))
        print(table[-1], flush=True)
    if options.markdown:
        head = (
            "Virtual machine / compiled / native, processor time, medians, in turn (`python benchmarks/engines.py`). "
        )
        head += "Points alone are evaluated as the compiled solver does; the NLP's functions as IPOPT's are.\n\n"
        options.markdown.write_text(head + "\n".join(table) + "\n")


if __name__ == "__main__":
    main()
