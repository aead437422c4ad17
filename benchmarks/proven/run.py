"""Processor seconds from a problem to a proved plan: `python benchmarks/proven/run.py [part of a name ...]`.

Every motion of ``motions.py`` is planned by the default call in a fresh process and validated by ``rt.validate``. A
motion counts as proved where the planner's own measures hold and the validation passes. Without arguments the table is
written to ``RESULTS.md`` beside this file.

Seconds are those of the call of ``rt.plan``. Its first use imports modules, from cached bytecode; "again" is the same
call a second time in the same process. "Imports" are those before the call: the interpreter, packages, the robot and
the problem. Where every joint has a motor, "again" is compared with a fixed mesh of 50 Hermite-Simpson intervals.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

LIMIT = 300
"""Wall-clock seconds of one motion, validation included."""
BRIEF = 2.0
"""Seconds of a plan above which it is not repeated."""
INTERVALS = 50
"""Of the fixed mesh."""
HEAD = (
    "| motion | proved | processor [s] | again [s] | ratio | imports [s] | meshes | intervals | iterations | error "
    "| excess | objective | remark |"
)
RULE = "|---|---|---|---|---|---|---|---|---|---|---|---|---|"


def one(name: str) -> dict[str, object]:
    """Plan and validate a motion in this process."""
    from motions import MOTIONS

    import robotraj as rt

    warnings.simplefilter("ignore")
    problem = MOTIONS[name]()
    began = time.process_time()
    solution = rt.plan(problem, check=False, progress=False)
    seconds = time.process_time() - began
    again = ratio = None
    if seconds < BRIEF:
        again = _seconds(lambda: rt.plan(problem, check=False, progress=False))
        if solution.phases[0].exact:
            mesh = rt.Mesh(INTERVALS, rt.HermiteSimpson())
            fixed = [_seconds(lambda: rt.plan(problem, mesh, check=False, progress=False)) for _ in range(2)]
            ratio = again / min(fixed)
    report = rt.validate(solution)
    proof = solution.proof
    return {
        "proved": solution.success and report.passed and proof is not None and proof.motion_holds,
        "seconds": seconds,
        "again": again,
        "ratio": ratio,
        "imports": began,
        "meshes": len(solution.refinement),
        "intervals": sum(part.mesh.count for part in solution.phases),
        "iterations": solution.iterations,
        "error": None if proof is None else proof.error,
        "excess": None if proof is None else proof.excess,
        "unsettled": None if proof is None else max(proof.quadrature, proof.unsettled),
        "remark": _remark(solution, report),
    }


def _seconds(call: Callable[[], object]) -> float:
    began = time.process_time()
    call()
    return time.process_time() - began


def _remark(solution: object, report: object) -> str:
    """Return the parts of the proof that do not hold."""
    status, proof = solution.status.value, solution.proof
    if not solution.success:
        return status
    if not report.passed:
        return " ".join(report.failures(report.tolerances)).split(".")[0]
    return "" if proof.holds else "objective not settled"


def in_a_fresh_process(name: str, cache: str) -> dict[str, object]:
    """Plan a motion in a separate process, with bytecode from a folder."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPYCACHEPREFIX": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, __file__, "--one", name]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False, env=environment)
    except subprocess.TimeoutExpired:
        return {"proved": False, "seconds": float(LIMIT), "remark": f"stopped after {LIMIT} s"}
    if done.returncode:
        return {"proved": False, "seconds": float("nan"), "remark": done.stderr.strip().splitlines()[-1][:100]}
    return json.loads(done.stdout.splitlines()[-1])


def line(name: str, found: dict[str, object]) -> str:
    """Write a row of the table."""

    def shown(key: str, form: str) -> str:
        value = found.get(key)
        return "" if value is None else format(value, form)

    cells = (
        name,
        "yes" if found["proved"] else "no",
        shown("seconds", ".3f"),
        shown("again", ".3f"),
        shown("ratio", ".1f"),
        shown("imports", ".2f"),
        shown("meshes", "d"),
        shown("intervals", "d"),
        shown("iterations", "d"),
        shown("error", ".0e"),
        shown("excess", ".0e"),
        shown("unsettled", ".0e"),
        str(found["remark"]),
    )
    return f"| {' | '.join(cells)} |"


def main(arguments: list[str]) -> None:
    """Print a row a motion, then the share and the median."""
    sys.path.insert(0, str(Path(__file__).parent))
    if arguments[:1] == ["--one"]:
        print(json.dumps(one(arguments[1])))
        return
    from motions import MOTIONS

    names = [name for name in MOTIONS if not arguments or any(part in name for part in arguments)]
    lines, found = [HEAD, RULE], []
    print(f"{HEAD}\n{RULE}")
    with tempfile.TemporaryDirectory() as cache:
        in_a_fresh_process(names[0], cache)  # writes the bytecode
        for name in names:
            found.append(in_a_fresh_process(name, cache))
            lines.append(line(name, found[-1]))
            print(lines[-1], flush=True)
    proved = [each for each in found if each["proved"]]
    seconds = [float(str(each["seconds"])) for each in proved]
    end = f"{len(proved)} of {len(found)} proved; processor time in the median {np.median(seconds):.2f} s."
    print(f"\n{end}")
    if not arguments:
        head = (
            "Written by `python benchmarks/proven/run.py`: default calls, each in a fresh process, one thread. "
            "That file describes the columns."
        )
        title = "# From a problem to a proved plan"
        Path(__file__).with_name("RESULTS.md").write_text("\n".join([title, "", head, "", *lines, "", end, ""]))


if __name__ == "__main__":
    main(sys.argv[1:])
