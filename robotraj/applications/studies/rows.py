"""Rows of a study: what is kept of the plan of a case."""

from __future__ import annotations

import resource
import socket
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj._util.errors import InputError

if TYPE_CHECKING:
    import pyarrow as pa

    from robotraj.applications.many.failure import Failure
    from robotraj.applications.studies.cases import Case
    from robotraj.solution.solution import Solution
    from robotraj.witness.report import Report

KNOTS = 64
"""Times of the motion of a row, evenly from its start to its end."""
CASE = "case_"
"""Prefix of the columns of a case."""
CURVES = "q", "v", "tau"

Row = dict[str, Any]


def own_version() -> str:
    """Return the version of this package."""
    try:
        return version("robotraj")
    except PackageNotFoundError:
        return "source"


def arrow() -> Any:
    """Return the module ``pyarrow``.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        import pyarrow
    except ImportError as error:
        raise InputError("A study needs pyarrow: pip install 'robotraj[study]'.") from error
    return pyarrow


def schema_of(case: Case) -> pa.Schema:
    """Return the columns of a study and their types, for cases like this one."""
    pa = arrow()
    kinds = {bool: pa.bool_(), int: pa.float64(), float: pa.float64(), str: pa.string()}
    texts = ("key", "status", "message", "host", "version")
    numbers = ("objective", "duration", "seconds", "memory", "error", "excess", "quadrature", "unsettled", "drift")
    return pa.schema(
        [
            *((name, pa.string()) for name in texts),
            ("conflicts", pa.list_(pa.string())),
            ("success", pa.bool_()),
            ("proved", pa.bool_()),
            ("validated", pa.bool_()),
            ("iterations", pa.int64()),
            *((name, pa.float64()) for name in numbers),
            *((CASE + name, kinds[type(value)]) for name, value in case.items()),
            ("t", pa.list_(pa.float32())),
            *((name, pa.list_(pa.float32())) for name in CURVES),
        ]
    )


def row_of(found: Solution | Failure, key: str, case: Case, seconds: float) -> Row:
    """Return the row of a plan or of its failure.

    Motions have ``KNOTS`` times: ``t`` [s], and ``q``, ``v``, ``tau`` one time after the other. Motions of a System
    have its states in ``q`` and its controls in ``tau``.
    """
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    row: Row = {
        "key": key,
        "status": found.status.value,
        "message": found.cause,
        "success": found.success,
        "objective": float(found.objective),
        "iterations": found.iterations,
        "seconds": seconds,
        "memory": megabytes,
        "host": socket.gethostname(),
        "version": own_version(),
        **{CASE + name: float(value) if type(value) is int else value for name, value in case.items()},
    }
    phases = getattr(found, "phases", None)
    if phases is None:
        return row
    solution: Solution = found  # type: ignore[assignment]
    row |= {"duration": solution.duration, "conflicts": [str(each) for each in solution.conflicts]}
    if solution.proof is not None:
        proof = solution.proof
        row |= {"proved": solution.proved}
        row |= {name: float(getattr(proof, name)) for name in ("error", "excess", "quadrature", "unsettled")}
    return row | _motion(solution)


def drift_of(report: Report) -> float | None:
    """Return the largest drift of a simulation; None where it was not measured."""
    return None if report.drift is None else float(report.drift.worst.largest)


def _motion(solution: Solution) -> Row:
    start = solution.phases[0].t0
    times = np.linspace(start, start + solution.duration, KNOTS)
    sample = solution.at(times)
    if solution.phases[0].phase.robot is not None:
        curves = {name: np.asarray(getattr(sample, name)) for name in CURVES}
    else:
        values = {"q": sample.x, "tau": sample.u}
        curves = {name: np.column_stack([np.asarray(own[k]) for k in own]) for name, own in values.items()}
    return {"t": times.astype(np.float32), **{name: c.astype(np.float32).ravel() for name, c in curves.items()}}
