"""What a study costs, and a million plans on a thousand processors: `python benchmarks/scale/run.py` writes RESULTS.md.

Random reaches of the panda are planned in this process and as a study, in turn; seconds are processor seconds. The
reaches need not keep off the arm's own body, so that plans are short and the cost of a study shows. The
cluster is simulated from the measured seconds: chunks go to free processors one after the other, some plans never end
until their limit, and processors fail and come back. What a failed processor had not written is planned again. Chunks
are no larger than half of a processor's share of the plans that are left, as in ``rt.sweep``.
"""

from __future__ import annotations

import heapq
import os
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import robotraj as rt
from robotraj.applications.many.processes import kept
from robotraj.applications.studies.cases import as_cases
from robotraj.applications.studies.store import Store

ROUNDS, COUNT = 2, 16
STORED, OF_FILE = 20_000, 100
"""Rows of the study that is opened, and those of each of its files."""
PLANS, PROCESSORS = 1_000_000, 1000
STUCK, LIMIT = 1e-4, 20.0
"""Share of plans that never end, and their time limit [s]."""
START, HANDED, FAILS, BACK = 10.0, 4e-3, 24 * 3600.0, 60.0
"""Start of a worker, time of the scheduler for a chunk, mean time between failures, and pause after one [s]."""
TABLE = Path(__file__).with_name("RESULTS.md")


def reach_of(robot: rt.Robot) -> Any:
    """Return the function that makes a reach between random configurations of the inner 60 % of the ranges."""
    low, high = np.array(robot.model.lowerPositionLimit), np.array(robot.model.upperPositionLimit)

    def make(case: Any) -> rt.Phase:
        middle, half = (low + high) / 2, 0.3 * (high - low)
        ends = np.random.default_rng(int(case["seed"])).uniform(middle - half, middle + half, (2, len(low)))
        states = [rt.State(q=q, v=0) for q in ends]
        return rt.Phase(
            robot, duration=2.0, start=states[0], end=states[1], objective=rt.Effort(), self_collision=False
        )

    return make


def processor_seconds() -> float:
    """Return the processor time of this process and of the workers of this machine [s]."""
    total, pool = sum(os.times()[:4]), kept(start=False)
    for process in pool.running if pool is not None else ():
        entries = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        total += (int(entries[11]) + int(entries[12])) / os.sysconf("SC_CLK_TCK")
    return total


def measured() -> tuple[list[tuple[str, str]], NDArray[np.float64], float]:
    """Return rows of the table, the seconds of each plan, and bytes of each."""
    robot = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    make, here, study = reach_of(robot), 0.0, 0.0
    with tempfile.TemporaryDirectory() as folder:
        rt.sweep(make, [{"seed": 10_000 + i} for i in range(4)], store=folder)
        rt.plan(make({"seed": 20_000}), progress=False, check=False)
        for number in range(ROUNDS):
            cases = [{"seed": COUNT * number + i} for i in range(COUNT)]
            began = processor_seconds()
            for case in cases:
                rt.plan(make(case), progress=False, check=False)
            here += processor_seconds() - began
            began = processor_seconds()
            found = rt.sweep(make, cases, store=folder)
            study += processor_seconds() - began
        size = sum(path.stat().st_size for path in Path(folder, "rows").iterdir()) / len(found)
        seconds = found.figures.column("seconds").to_numpy(zero_copy_only=False)
        proved = sum(found.figures.column("proved").to_pylist())
        count, opened = found.figures.num_rows, seconds_to_open(found, Path(folder, "large"))
    plans = ROUNDS * COUNT
    rows = [
        ("a plan in this process", f"{1e3 * here / plans:.0f} ms"),
        ("a plan of a study, workers and client", f"{1e3 * study / plans:.0f} ms, ratio {study / here:.2f}"),
        ("a row in the folder", f"{size / 1e3:.1f} kB"),
        ("proved", f"{proved} of {count}"),
        (f"open {STORED:,} rows, read figures, failures and a motion", f"{1e3 * opened:.0f} ms"),
    ]
    return rows, seconds, size


def seconds_to_open(known: rt.Study, folder: Path) -> float:
    """Return the processor seconds in which a study of ``STORED`` rows, copies of known ones, is opened and queried."""
    rows, store = known.table.to_pylist(), Store(folder, create=True)
    cases = as_cases([{"seed": k} for k in range(STORED)], "copies")
    store.begin(cases, {"digest": "copies"})
    keys = list(cases.by_key)
    for i in range(0, STORED, OF_FILE):
        store.add(
            [{**rows[k % len(rows)], "key": keys[k], "case_seed": float(k)} for k in range(i, i + OF_FILE)], cases
        )
    began = time.process_time()
    study = rt.Study(folder)
    assert study.figures.num_rows == STORED
    assert not study.failures.num_rows
    study.motion(keys[STORED // 2])
    return time.process_time() - began


def simulated(seconds: NDArray[np.float64], chunk: int, stuck: float) -> tuple[float, float, int, int]:
    """Return minutes until all plans are done, the share of processors in use, and the chunks lost and written."""
    random = np.random.default_rng(0)
    free = [(START + random.uniform(0.0, 30.0), k) for k in range(PROCESSORS)]
    heapq.heapify(free)
    fails, clock, busy, lost, last = random.exponential(FAILS, PROCESSORS), 0.0, 0.0, 0, 0.0
    left, written = PLANS, 0
    while left:
        ready, k = heapq.heappop(free)
        clock = max(clock, ready) + HANDED
        count = max(1, min(chunk, left // (2 * PROCESSORS)))
        costs = random.choice(seconds, count)
        took = float(np.where(random.random(count) < STUCK, stuck, costs).sum())
        if clock + took > fails[k]:
            lost += 1
            back = max(fails[k], clock) + BACK + START
            fails[k] = back + random.exponential(FAILS)
            heapq.heappush(free, (back, k))
            continue
        busy, left, written, last = busy + took, left - count, written + 1, max(last, clock + took)
        heapq.heappush(free, (clock + took, k))
    return last / 60.0, busy / (last * PROCESSORS), lost, written


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore")
    rows, seconds, size = measured()
    lines = [f"# {PLANS:,} plans on {PROCESSORS:,} processors", "", *(__doc__ or "").splitlines()[2:], ""]
    lines += ["| measured | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows), ""]
    lines += ["| simulated | minutes | processors in use | chunks lost | files |", "|---|---|---|---|---|"]
    of_chunk = max(1, round(20.0 / float(seconds.mean())))
    for name, chunk, stuck in (
        (f"chunks of 20 s ({of_chunk} plans), limit {LIMIT:g} s", of_chunk, LIMIT),
        (f"chunks of 20 s, stuck plans end after an hour ({STUCK:g} of all)", of_chunk, 3600.0),
        ("chunks of 200 s, limit 20 s", 10 * of_chunk, LIMIT),
    ):
        minutes, used, lost, files = simulated(seconds, chunk, stuck)
        lines.append(f"| {name} | {minutes:.1f} | {used:.0%} | {lost} | {files} |")
    lines += ["", f"The rows take {size * PLANS / 1e9:.1f} GB. With one plan a task, the scheduler would need "]
    lines[-1] += f"{PLANS * HANDED / 60.0:.0f} minutes to hand out the tasks."
    TABLE.write_text("\n".join(lines) + "\n")
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
