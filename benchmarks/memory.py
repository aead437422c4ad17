"""Peak memory of large plans, each in a fresh process: `python benchmarks/memory.py`.

A ur5 on 2,000 intervals, solved; a whole-body Talos step (32 motors, flat feet) on 100 intervals, ten iterations, after
which no solver takes more.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time

import robotraj as rt


def ur5() -> rt.Solution:
    """Plan T4 on 2,000 intervals."""
    ends = [rt.State(q=q, v=0) for q in ([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2])]
    phase = rt.Phase(rt.load("ur5"), 1.0, *ends, objective=rt.Effort())
    return rt.plan(phase, rt.Mesh(2000), interval_limits=rt.interval_limits.BernsteinBounds(), progress=False)


def talos() -> rt.Solution:
    """Begin a whole-body step on 38 + 62 intervals."""
    from talos import step

    mesh = [rt.Mesh(count) for count in (38, 62)]
    return rt.plan(step(), mesh, solver=rt.Ipopt(max_iterations=10), check=False, progress=False)


TASKS = {"ur5, 2,000 intervals": ur5, "whole-body Talos, 100 intervals, 10 iterations": talos}


def main() -> None:
    """Run each task in a process, or the one that is named."""
    if len(sys.argv) > 1:
        used = time.process_time()
        solution = TASKS[sys.argv[1]]()
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        used = time.process_time() - used
        print(f"| {sys.argv[1]} | {solution.status.value} | {solution.iterations} | {used:.1f} | {peak:.0f} |")
        return
    print("| plan | status | iterations | processor [s] | peak memory [MB] |\n|---|---|---|---|---|", flush=True)
    for name in TASKS:
        subprocess.run([sys.executable, __file__, name], check=True)


if __name__ == "__main__":
    main()
