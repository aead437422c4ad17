"""Who plans the cases of a study: processes of this machine, or chunks for the executor of a cluster."""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

import cloudpickle

from robotraj.applications.many.failure import failure_of
from robotraj.applications.many.processes import WorkerDied, kept, release_kept
from robotraj.applications.many.workers import KILLED
from robotraj.applications.studies.cases import Case
from robotraj.applications.studies.progress import Progress
from robotraj.applications.studies.rows import Row, row_of
from robotraj.applications.studies.store import Store
from robotraj.applications.studies.work import Keyed, Recipe, limited, plan_chunk, write

CHUNK = 20.0
"""Time of work [s] whose rows are one file: what is lost where a machine fails."""
WAITING = 3
"""Cases or chunks that wait for each worker, so that none is idle."""
WINDOW = 5000
"""Chunks at once for an executor of unknown size."""
WIDEST, SHARES = 1000, 64
"""Largest number of cases of a chunk, and the least number of chunks that are left for an executor of unknown size."""


def plan_here(recipe: Recipe, cases: Iterator[tuple[str, Case]], store: Store, progress: Progress) -> None:
    """Plan cases in processes of this machine; rows are written every ``CHUNK`` seconds, and at the end.

    Raises
    ------
    KeyboardInterrupt
        Ctrl-C was pressed; what was planned is written.
    """
    pool, data = kept(), cloudpickle.dumps(recipe)
    assert pool is not None
    running: dict[Future[Row], tuple[str, Case, int]] = {}
    rows: list[Row] = []
    written = time.monotonic()

    def begin(key: str, case: Case, attempt: int = 0) -> None:
        running[pool.submit(limited, data, key, case)] = key, case, attempt

    try:
        for key, case in cases:
            begin(key, case)
            while len(running) >= (1 + WAITING) * len(os.sched_getaffinity(0)):
                rows += _finished(running, begin, progress)
            if time.monotonic() - written > CHUNK and rows:
                write(store, rows, recipe.cases)
                rows, written = [], time.monotonic()
        while running:
            rows += _finished(running, begin, progress)
    except KeyboardInterrupt:
        release_kept()
        raise
    finally:
        if rows:
            write(store, rows, recipe.cases)


def _finished(
    running: dict[Future[Row], tuple[str, Case, int]], begin: Callable[[str, Case, int], None], progress: Progress
) -> list[Row]:
    """Wait for a case; return the rows of all that are done. A case that was killed from outside begins again."""
    done, _ = wait(running, return_when=FIRST_COMPLETED)
    rows = []
    for future in done:
        key, case, attempt = running.pop(future)
        try:
            row = future.result()
        except WorkerDied as died:
            if died.code == -signal.SIGKILL and attempt < KILLED:
                begin(key, case, attempt + 1)
                continue
            row = row_of(failure_of(0, died), key, case, math.nan)
        except Exception as error:
            row = row_of(failure_of(0, error), key, case, math.nan)
        progress.add(1, not row["success"], row["seconds"], key)
        rows.append(row)
    return rows


def plan_elsewhere(
    recipe: Recipe, cases: Iterator[tuple[str, Case]], executor: Executor, progress: Progress
) -> dict[str, str]:
    """Hand chunks of about ``CHUNK`` seconds to an executor, whose workers write the rows.

    Returns
    -------
    dict of str to str
        Why chunks were lost, by the key of their first case: the next start plans them.
    """
    data = cloudpickle.dumps(recipe)
    running: dict[Future[tuple[int, int, float]], Keyed] = {}
    lost: dict[str, str] = {}
    # Executors of clusters do not tell how many workers they have, which may change.
    known = int(getattr(executor, "_max_workers", 0) or 0)
    most = (1 + WAITING) * known if known else WINDOW

    def harvest() -> None:
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            chunk = running.pop(future)
            try:
                progress.add(*future.result(), chunk[0][0])
            except Exception as error:
                lost[chunk[0][0]] = f"{type(error).__name__}: {error}"

    for chunk in _chunks(cases, progress, 2 * known or SHARES):
        try:
            running[executor.submit(plan_chunk, data, chunk)] = chunk
        except RuntimeError as error:
            lost[chunk[0][0]] = f"{type(error).__name__}: {error}"
            break
        # The first cases are chunks of their own, whose time decides how long later chunks are.
        while len(running) >= (most if progress.done else min(most, 1 + WAITING)):
            harvest()
    while running:
        harvest()
    return lost


def _chunks(cases: Iterator[tuple[str, Case]], progress: Progress, shares: int) -> Iterator[list[tuple[str, Case]]]:
    """Yield cases of about ``CHUNK`` seconds of work, as measured so far; single ones before the first is done.

    A chunk is no larger than one of ``shares`` of the cases that are left, so that all workers end at about one time.
    """
    chunk: list[tuple[str, Any]] = []
    handed = 0
    for each in cases:
        chunk.append(each)
        size = min(CHUNK * progress.done / max(progress.seconds, 1e-3), (progress.total - handed) / shares, WIDEST)
        if len(chunk) >= size:
            handed += len(chunk)
            yield chunk
            chunk = []
    if chunk:
        yield chunk
