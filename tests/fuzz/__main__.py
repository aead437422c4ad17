"""Fuzz for hours: `python tests/fuzz --hours 1`, or `--seeds 1000`. It prints the seeds that fail, for the tests.

`--proofs` draws problems with known answers and prints the share of proved plans that are wrong; `--interrupts 100`
presses Ctrl-C.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
import warnings
from pathlib import Path

import judge
from calls import Calls, fault
from guard import Guard
from interrupts import faults
from mjcf_files import hostile_mjcf
from proofs import Tally
from random_problems import random_case
from saved_files import good_files, hostile_file
from texts import hostile_mesh, hostile_problem, hostile_srdf
from urdfs import hostile_urdf

FIRST = 100_000
"""First seed; the tests take those from 0 on."""


def main() -> None:
    """Try seeds until the time is over."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0)
    parser.add_argument("--first", type=int, default=FIRST, help="first seed")
    parser.add_argument("--interrupts", type=int, default=0, help="press Ctrl-C this often, and nothing else")
    parser.add_argument("--proofs", action="store_true", help="draw problems whose answer is known, and nothing else")
    parser.add_argument("--seeds", type=int, default=10**9, help="largest number of seeds")
    given = parser.parse_args()
    if given.proofs:
        tally, seed, end = Tally(), given.first, time.monotonic() + 3600.0 * given.hours
        while time.monotonic() < end and seed < given.first + given.seeds:
            tally.attempt(seed)
            seed += 1
        print(tally)
        raise SystemExit(bool(tally.wrong))
    if given.interrupts:
        with tempfile.TemporaryDirectory() as folder:
            found = faults(Path(folder), given.interrupts, given.first)
        print(*found, f"{given.interrupts} interrupts, {len(found)} failures", sep="\n")
        return
    end, seed, wrong, unsolved = time.monotonic() + 3600.0 * given.hours, given.first, 0, 0
    with tempfile.TemporaryDirectory() as folder, Guard() as guard:
        os.chdir(folder)  # calls may write files
        good, calls = good_files(Path(folder)), Calls()
        while time.monotonic() < end and seed < given.first + given.seeds:
            for kind, suffix, data in (
                ("saved", "npz", hostile_file(seed, good)),
                ("urdf", "urdf", hostile_urdf(seed)),
                ("mjcf", "xml", hostile_mjcf(seed)),
                ("problem", "toml", hostile_problem(seed)),
                ("srdf", "srdf", hostile_srdf(seed)),
                ("mesh", *hostile_mesh(seed)),
            ):
                path = Path(folder) / f"hostile.{suffix}"
                path.write_bytes(data)
                verdict = guard.attempt(kind, str(path))
                if not verdict.right:
                    wrong += 1
                    print(f"{kind} {seed}: {verdict.kind} {verdict.text[:500]}", flush=True)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                if found := fault(seed, calls):
                    wrong += 1
                    print(f"call {seed}: {found[:500]}", flush=True)
                end_of = judge.verdict(*judge.planned(random_case(seed)))
            unsolved += end_of == "unsolved"
            wrong += end_of not in ("solved", "unsolved")
            if end_of != "solved":
                print(f"problem {seed}: {end_of}", flush=True)
            seed += 1
    print(f"{seed - given.first} seeds from {given.first} on, {wrong} failures, {unsolved} problems unsolved")


if __name__ == "__main__":
    main()
