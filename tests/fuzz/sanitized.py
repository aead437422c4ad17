"""Generated problems, saved files and URDFs through a module with sanitizers: `bash .ci/sanitize` runs this.

A fault of the memory or undefined behaviour ends the process. On a terminal, the seed that was printed last is its
cause. What the plans claim is judged as in the tests. Problems of files and robots that load are transcribed and solved
for a few iterations, so that their numbers reach the module. The solver is the project's own, without IPOPT: CasADi
loads it in a way (RTLD_DEEPBIND) that the sanitizers do not allow.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
import warnings
from pathlib import Path

import judge
from attempts import load_saved, load_urdf
from random_problems import random_case
from saved_files import good_files, hostile_file
from urdfs import hostile_urdf, unchanged_urdf

import robotraj as rt
from robotraj.native.build import load_native
from robotraj.transcription.transcribe import transcribe

FIRST = 300_000
"""First seed."""
FILES = 5
"""Files and URDFs for each problem: they take less time."""
SOLVED = 0.9
"""Least share of solved problems: nothing is fallen back on, and the sanitizers make everything slower."""
SOLVER = rt.InteriorPoint(fallback=None)
BRIEF = rt.InteriorPoint(max_iterations=3, fallback=None)
"""For problems of files and robots that load, which need not have a solution."""


def problems(count: int) -> None:
    """Plan random problems; fail where a plan makes a false claim."""
    ends: dict[str, list[int]] = {}
    for seed in range(FIRST, FIRST + count):
        _show(f"problem {seed}")
        ends.setdefault(judge.verdict(*judge.planned(random_case(seed), SOLVER)), []).append(seed)
    print({end: len(seeds) for end, seeds in ends.items()})
    wrong = {end: seeds for end, seeds in ends.items() if end not in ("solved", "unsolved", "late")}
    if wrong or len(ends.get("solved", ())) < SOLVED * count:
        raise SystemExit(f"seeds by their ends: {ends}")


def _show(attempt: str) -> None:
    """Print an attempt before it is made, over the one before; a log needs no such lines."""
    if sys.stdout.isatty():
        print(f"{attempt:30}", end="\r", flush=True)


def files(count: int) -> None:
    """Load hostile saved files and URDFs, and solve for what loads; any error but an InputError ends the run."""
    with tempfile.TemporaryDirectory() as folder:
        good, path = good_files(Path(folder), SOLVER), Path(folder) / "hostile"
        attempts = {
            "saved file": lambda seed: _saved(path.with_suffix(".npz"), hostile_file(seed, good)),
            "URDF": lambda seed: _urdf(path.with_suffix(".urdf"), hostile_urdf(seed)),
            "unchanged URDF": lambda seed: _urdf(path.with_suffix(".urdf"), unchanged_urdf(seed)),
        }
        for name, attempt in attempts.items():
            loaded = 0
            for seed in range(FIRST, FIRST + count):
                _show(f"{name} {seed}")
                with contextlib.suppress(rt.InputError):
                    attempt(seed)
                    loaded += 1
            print(f"{name}: {loaded} of {count} loaded")


def _saved(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    load_saved(str(path))
    solution = rt.load_solution(path)
    _solve(solution.problem, rt.guess.FromSolution(solution))


def _urdf(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    load_urdf(str(path))
    _solve(rt.Problem([rt.Phase(rt.load(path), 1.0, objective=rt.Effort())]))


def _solve(problem: rt.Problem, guess: rt.guess.InitialGuess | None = None) -> None:
    BRIEF.solve(transcribe(problem, rt.Mesh(3), guess or rt.guess.default_guess(problem)))


def main() -> None:
    """Make that many attempts of each kind; fail where the module has no sanitizers."""
    count = int(sys.argv[1])
    if b"__asan_init" not in Path(load_native().__file__).read_bytes():
        raise SystemExit("the native module was not compiled with sanitizers")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        files(FILES * count)
        problems(count)


if __name__ == "__main__":
    main()
