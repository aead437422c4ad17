"""Simulations of the whole solutions that a study keeps."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robotraj._util.errors import InputError
from robotraj.applications.many.failure import Failure
from robotraj.applications.many.workers import run
from robotraj.applications.studies.rows import CASE, Row, arrow, drift_of
from robotraj.applications.studies.store import Store
from robotraj.solution.storage.load import load_solution

if TYPE_CHECKING:
    import pyarrow as pa

    from robotraj.applications.studies.cases import Case

Shared = tuple[Path, "Callable[[Case], Any] | None"]


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
