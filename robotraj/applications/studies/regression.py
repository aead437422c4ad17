"""What became worse between two studies of the same cases: for nightly runs, as a table and a verdict."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, table
from robotraj._util.values import dataclass
from robotraj.applications.studies.rows import CASE

if TYPE_CHECKING:
    import pyarrow as pa

MEASURES = {"duration": "longer", "objective": "costlier", "seconds": "slower"}
"""Columns whose rise is a regression, and its name."""


@dataclass(frozen=True)
class Regression(OneLine):
    """One case that became worse.

    Attributes
    ----------
    case : mapping
        Its numbers and words.
    kind : str
        ``"lost"``, ``"unproved"``, ``"longer"``, ``"costlier"`` or ``"slower"``.
    before, after : float or str
        The measure in both studies; the status where a plan was lost.
    """

    case: Mapping[str, Any]
    kind: str
    before: float | str
    after: float | str


@dataclass(frozen=True)
class Regressions(OneLine):
    """Cases that became worse from one study to the next.

    Attributes
    ----------
    found : tuple of Regression
        Lost and unproved ones first, then by their relative rise.
    compared, missing : int
        Number of cases in both studies, and of those that the later study lacks.
    """

    found: tuple[Regression, ...]
    compared: int
    missing: int

    def __bool__(self) -> bool:
        """Whether something became worse."""
        return bool(self.found)

    @property
    def unsafe(self) -> bool:
        """Whether a plan was lost or is no longer proved."""
        return any(each.kind in ("lost", "unproved") for each in self.found)

    def __str__(self) -> str:
        head = f"{self.compared} cases compared, {len(self.found)} regressions"
        head += f", {self.missing} not planned yet" if self.missing else ""
        rows = [
            (", ".join(f"{name} {_text(value)}" for name, value in each.case.items()), each.kind)
            + (_text(each.before), _text(each.after))
            for each in self.found
        ]
        return "\n".join([head, *(table([("case", "became", "before", "after"), *rows]) if rows else [])])


def regressions(
    before: pa.Table, after: pa.Table, *, longer: float = 1.01, costlier: float = 1.01, slower: float = 1.5
) -> Regressions:
    """Compare two studies case by case, whatever versions and options planned them.

    Parameters
    ----------
    before, after : pyarrow.Table
        Figures of the studies.
    longer, costlier, slower : float
        Ratios of duration, objective and processor seconds beyond which a case became worse.

    Raises
    ------
    InputError
        The studies have no case in common.
    """
    allowed = {"longer": longer, "costlier": costlier, "slower": slower}
    first, second = _by_case(before), _by_case(after)
    common = [case for case in first if case in second]
    if not common:
        raise InputError("The two studies have no case in common, so nothing can be compared.")
    found: list[tuple[float, Regression]] = []
    for key in common:
        old, new, case = first[key], second[key], dict(key)
        if not old["success"]:
            continue
        if not new["success"]:
            found.append((-np.inf, Regression(case, "lost", old["status"], new["status"])))
            continue
        if old["proved"] and not new["proved"]:
            found.append((-np.inf, Regression(case, "unproved", "proved", "not proved")))
        for name, kind in MEASURES.items():
            rise = (new[name] - old[name]) / max(abs(old[name]), 1e-12)
            if rise > allowed[kind] - 1.0:
                found.append((-rise, Regression(case, kind, old[name], new[name])))
    found.sort(key=lambda each: each[0])
    return Regressions(tuple(each for _, each in found), len(common), len(first) - len(common))


def _by_case(figures: pa.Table) -> dict[tuple[tuple[str, Any], ...], dict[str, Any]]:
    """Return the rows by the numbers of their cases; the last of equal ones."""
    return {
        tuple(sorted((name.removeprefix(CASE), row[name]) for name in row if name.startswith(CASE))): row
        for row in figures.to_pylist()
    }


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.5g}"
