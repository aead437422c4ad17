"""Cases of a study: rows of numbers and words, each with the key of its plan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.applications.studies.digest import digest_of

Entry: TypeAlias = float | int | str | bool
Case: TypeAlias = Mapping[str, Entry]


@dataclass(frozen=True, eq=False)
class Cases:
    """Distinct cases by key, in the order in which they were given.

    Attributes
    ----------
    digest : str
        Digest of all that the plans share: ``make``, options, version.
    names : tuple of str
        Columns.
    by_key : mapping of str to mapping
        Each case once.
    """

    digest: str
    names: tuple[str, ...]
    by_key: Mapping[str, Case]

    @property
    def ranges(self) -> dict[str, float]:
        """Range of each number."""
        columns = {name: [case[name] for case in self.by_key.values()] for name in self.names}
        return {
            name: float(np.ptp(np.array(values, dtype=float)))
            for name, values in columns.items()
            if not any(isinstance(value, str) for value in values)
        }


def as_cases(given: object, digest: str) -> Cases:
    """Return the cases of a list of dicts, a table with named columns, or an array (n, k), columns ``x0``, ``x1`` ...

    Raises
    ------
    InputError
        There is no case, or a case has other columns than the first, or an entry that is no finite number or text.
    """
    rows = _rows(given)
    if not rows:
        raise InputError("A study needs at least one case; got none.")
    names = tuple(rows[0])
    by_key: dict[str, Case] = {}
    for number, row in enumerate(rows):
        if tuple(row) != names and set(row) != set(names):
            raise InputError(f"Case {number} has the columns {sorted(row)}, but the first has {sorted(names)}.")
        case = {name: _entry(row[name], name, number) for name in names}
        by_key.setdefault(digest_of(digest, case), case)
    return Cases(digest, names, by_key)


def _rows(given: object) -> list[Mapping[str, object]]:
    if hasattr(given, "to_dict") and hasattr(given, "columns"):  # pandas
        return list(given.to_dict("records"))
    if hasattr(given, "to_dicts"):  # polars
        return list(given.to_dicts())
    if hasattr(given, "to_pylist"):  # pyarrow
        return list(given.to_pylist())
    if isinstance(given, np.ndarray):
        if given.ndim != 2:
            raise InputError(f"Cases are an array (n, k), one row each; got the shape {given.shape}.")
        return [{f"x{i}": value for i, value in enumerate(row)} for row in given.tolist()]
    listed: Sequence[object] = list(given) if isinstance(given, Iterable) else [given]
    for number, row in enumerate(listed):
        if not isinstance(row, Mapping) or not all(isinstance(name, str) and name for name in row):
            raise InputError(
                f"Case {number} is {row!r:.80}; give dicts such as {{'speed': 0.3}}, an array (n, k) or a table."
            )
    return listed  # type: ignore[return-value]


def _entry(value: object, name: str, number: int) -> Entry:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str | bool | int) or (isinstance(value, float) and np.isfinite(value)):
        return value
    raise InputError(f"Case {number}: {name!r} is {value!r:.80}; give a finite number, a text, or True or False.")
