"""Generated problems through a module that is compiled with sanitizers: `bash .ci/sanitize` runs this.

A fault of the memory or undefined behaviour ends the process. What the plans claim is judged as in the tests. The
solver is the project's own, without IPOPT: CasADi loads it in a way (RTLD_DEEPBIND) that the sanitizers do not allow.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import judge
from random_problems import random_case

import robotraj as rt
from robotraj.native.build import load_native

FIRST = 300_000
"""First seed."""
SOLVED = 0.9
"""Least share of solved problems: nothing is fallen back on, and the sanitizers make everything slower."""
SOLVER = rt.InteriorPoint(fallback=None)


def main() -> None:
    """Plan that many problems; fail where the module has no sanitizers or a plan makes a false claim."""
    count = int(sys.argv[1])
    if b"__asan_init" not in Path(load_native().__file__).read_bytes():
        raise SystemExit("the native module was not compiled with sanitizers")
    ends: dict[str, list[int]] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for seed in range(FIRST, FIRST + count):
            ends.setdefault(judge.verdict(*judge.planned(random_case(seed), SOLVER)), []).append(seed)
    print({end: len(seeds) for end, seeds in ends.items()})
    wrong = {end: seeds for end, seeds in ends.items() if end not in ("solved", "unsolved", "late")}
    if wrong or len(ends.get("solved", ())) < SOLVED * count:
        raise SystemExit(f"seeds by their ends: {ends}")


if __name__ == "__main__":
    main()
