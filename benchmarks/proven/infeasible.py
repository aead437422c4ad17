"""Whether a failure names the conflicting row: `python benchmarks/proven/infeasible.py [part of a name ...]`.

Every problem of ``infeasible_problems.py`` has no solution. It is built and planned by the default call in a fresh
process. A row of the table is right where the first cause contains the row and the joint that conflict. Its value must
lie in the interval that suffices. Without arguments the table is written to ``INFEASIBLE.md`` beside this file.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
import warnings
from pathlib import Path

LIMIT = 120
"""Wall-clock seconds of one problem."""
SECONDS = 3.0
"""Processor seconds in which a cause is to be found."""
HEAD = "| problem | right | processor [s] | first cause |"
RULE = "|---|---|---|---|"


def one(name: str) -> dict[str, object]:
    """Plan a problem in this process and judge the message of its failure."""
    from infeasible_problems import PROBLEMS

    import robotraj as rt

    problem = PROBLEMS[name]
    began = time.process_time()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            rt.plan(problem.build(), progress=False)
            cause = ""
        except rt.NoSolutionFound as error:
            cause = str(error).partition(" not solved: ")[2].partition("\n")[0]
        except rt.InputError as error:
            cause = str(error)
    seconds = time.process_time() - began
    cause = cause or " ".join(str(each.message) for each in warned if each.category is UserWarning)
    named = all(any(word in cause for word in words.split("|")) for words in problem.names)
    if problem.needed is not None:
        values = [abs(float(each)) for each in re.findall(r"(?:to become|must become|at least) (-?[\d.]*\d)", cause)]
        named = named and any(problem.needed[0] <= each <= problem.needed[1] for each in values)
    return {"right": named, "seconds": seconds, "cause": cause}


def in_a_fresh_process(name: str) -> dict[str, object]:
    """Plan a problem in a separate process."""
    try:
        done = subprocess.run(
            [sys.executable, __file__, "--one", name], capture_output=True, text=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return {"right": False, "seconds": float(LIMIT), "cause": "stopped"}
    if done.returncode:
        return {"right": False, "seconds": float("nan"), "cause": done.stderr.strip().splitlines()[-1][:100]}
    return json.loads(done.stdout.splitlines()[-1])


def main(arguments: list[str]) -> None:
    """Print a row a problem, then how many are right."""
    sys.path.insert(0, str(Path(__file__).parent))
    if arguments[:1] == ["--one"]:
        print(json.dumps(one(arguments[1])))
        return
    from infeasible_problems import PROBLEMS

    names = [name for name in PROBLEMS if not arguments or any(part in name for part in arguments)]
    lines, found = [HEAD, RULE], []
    print(f"{HEAD}\n{RULE}")
    for name in names:
        found.append(in_a_fresh_process(name))
        right, seconds, cause = (found[-1][key] for key in ("right", "seconds", "cause"))
        lines.append(f"| {name} | {'yes' if right else 'no'} | {seconds:.2f} | {str(cause).replace('|', '/')[:200]} |")
        print(lines[-1], flush=True)
    right = sum(bool(each["right"]) for each in found)
    quick = sum(bool(each["right"]) and float(str(each["seconds"])) < SECONDS for each in found)
    end = f"{right} of {len(found)} causes are right, {quick} of them in under {SECONDS:g} s of processor time."
    print(f"\n{end}")
    if not arguments:
        head = (
            "Written by `python benchmarks/proven/infeasible.py`: default calls, each in a fresh process, one thread."
        )
        title = "# Problems without a solution: which limit must give"
        Path(__file__).with_name("INFEASIBLE.md").write_text("\n".join([title, "", head, "", *lines, "", end, ""]))


if __name__ == "__main__":
    main(sys.argv[1:])
