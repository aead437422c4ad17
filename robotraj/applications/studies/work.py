"""What a worker does: it makes the problem of a case, plans it, and returns or writes its row."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import cloudpickle

from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.failure import Failure, failure_of
from robotraj.applications.many.libraries.neighbours import Neighbours
from robotraj.applications.many.posed import posed
from robotraj.applications.many.processes import WorkerDied, kept
from robotraj.applications.many.workers import run
from robotraj.applications.studies.rows import CASE, Row, arrow, drift_of, row_of
from robotraj.applications.studies.store import Store
from robotraj.planning.plan import plan
from robotraj.solution.released import released
from robotraj.solution.storage.load import load_solution

if TYPE_CHECKING:
    import pyarrow as pa

    from robotraj.applications.many.options import GuessedChoices
    from robotraj.applications.studies.cases import Case, Cases
    from robotraj.solution.solution import Solution

Make = Callable[["Case"], Any]
Keyed = Sequence[tuple[str, "Case"]]

ATTEMPTS, PAUSE = 12, 5.0
"""Attempts to write a file while the disk is full, and the time between two [s]."""
Shared = tuple[Path, "Callable[[Case], Any] | None"]


@dataclass(frozen=True, eq=False)
class Recipe:
    """What the plans of a study share; it is sent once a worker.

    Attributes
    ----------
    make : callable
        Returns the problem of a case.
    options : mapping
        Options of ``rt.plan``.
    folder : Path
        Folder of the store.
    whole : bool
        Whether whole solutions are kept as ``.npz`` beside the rows.
    validate : bool
        Whether each plan is validated by simulation.
    limits : CaseLimits
    cases : Cases
        Digest and columns; workers need no other cases.
    ranges : mapping of str to float, optional
        Range of each number of the cases where plans start from solved neighbours; None where they do not.
    """

    make: Make
    options: Mapping[str, Any]
    folder: Path
    whole: bool
    validate: bool
    limits: CaseLimits
    cases: Cases
    ranges: Mapping[str, float] | None = None

    @cached_property
    def solved(self) -> dict[tuple[object, ...], Neighbours]:
        """Neighbours that this process has solved, by the words of their cases."""
        return {}


def planned(recipe: Recipe, key: str, case: Case) -> Row:
    """Plan a case and return its row; errors are rows as well."""
    began = time.process_time()
    found: Solution | Failure
    try:
        found = _found(recipe, case)
        checked = _validated(found) if recipe.validate and found.success else {}
        if recipe.whole:
            found.save(Store(recipe.folder).solution(key))
    except (Exception, SystemExit) as error:
        found, checked = failure_of(0, error), {}
    return row_of(found, key, case, time.process_time() - began) | checked


def _found(recipe: Recipe, case: Case) -> Solution:
    """Plan a case, from the nearest one that this process has solved where the study is a chain."""
    problem = posed(recipe.make, case)
    if recipe.ranges is None:
        return plan(problem, check=False, progress=False, **recipe.options)
    words = tuple(value for name, value in case.items() if name not in recipe.ranges)
    near = recipe.solved.setdefault(words, Neighbours(recipe.ranges))
    numbers = {name: float(case[name]) for name in recipe.ranges}
    found = near.plan(cast("GuessedChoices", recipe.options), problem, numbers)
    if found.success:
        near.add(numbers, found)
    return released(found)


def limited(recipe: bytes, key: str, case: Case) -> Row:
    """Plan a case under limits of the operating system."""
    own = unpacked(recipe)
    if not own.limits:
        return planned(own, key, case)
    with own.limits.imposed():
        return planned(own, key, case)


def planned_apart(recipe: bytes, key: str, case: Case) -> Row:
    """Plan a case in a process of its own, whose end is a row as well."""
    pool = kept()
    assert pool is not None
    try:
        return pool.submit(limited, recipe, key, case).result()
    except WorkerDied as died:
        return row_of(failure_of(0, died), key, case, float("nan"))


def plan_chunk(recipe: bytes, chunk: Keyed) -> tuple[int, int, float]:
    """Plan cases one after the other and write their rows as one file.

    Returns
    -------
    done, failed : int
    seconds : float
        Processor time of the plans [s].
    """
    own = unpacked(recipe)
    alone = planned_apart if own.limits else limited
    rows = [alone(recipe, key, case) for key, case in chunk]
    write(Store(own.folder), rows, own.cases)
    return len(rows), sum(not row["success"] for row in rows), sum(row["seconds"] for row in rows)


def write(store: Store, rows: Sequence[Row], cases: Cases) -> None:
    """Write rows as one file, again after a pause while the disk is full.

    Raises
    ------
    InputError
        It is still full after ``ATTEMPTS`` attempts.
    """
    for attempt in range(ATTEMPTS):
        try:
            return store.add(rows, cases)
        except InputError:
            if attempt == ATTEMPTS - 1:
                raise
            time.sleep(PAUSE)


@lru_cache(maxsize=2)
def unpacked(recipe: bytes) -> Recipe:
    """Return the recipe of a message, once a process."""
    found: Recipe = cloudpickle.loads(recipe)
    return found


def _validated(solution: Solution) -> Row:
    from robotraj.witness.validation import validate

    report = validate(solution)
    return {"validated": report.passed, "drift": drift_of(report)}


def validated(store: Store, make: Callable[[Case], Any] | None, executor: Executor | None) -> pa.Table:
    """Return a table of the simulations of all solved cases; see ``Study.validate``."""
    names = [name for name in store.columns() if name.startswith(CASE)]
    rows = store.table(["key", "success", *names]).to_pylist() if names else []
    tasks = [
        (row["key"], {name.removeprefix(CASE): row[name] for name in names})
        for row in rows
        if row["success"] and store.solution(row["key"]).exists()
    ]
    if not tasks:
        raise InputError(
            'The study keeps no whole solution: rt.sweep(..., keep="all") keeps them; validate=True simulates all.'
        )
    found = run(_simulated, (store.folder, make), tasks, executor)
    schema = arrow().schema([("key", "string"), ("passed", "bool"), ("drift", "float64"), ("message", "string")])
    entries = [
        {"key": key, "passed": False, "message": entry.message} if isinstance(entry, Failure) else entry
        for (key, _), entry in zip(tasks, found, strict=True)
    ]
    return arrow().Table.from_pylist(entries, schema=schema)


def _simulated(shared: Shared, task: tuple[str, Case]) -> Row:
    from robotraj.witness.validation import validate

    folder, make = shared
    key, case = task
    solution = load_solution(Store(folder).solution(key), None if make is None else make(case))
    report = validate(solution)
    return {
        "key": key,
        "passed": report.passed,
        "drift": drift_of(report),
        "message": "; ".join(report.failures(report.tolerances)),
    }
