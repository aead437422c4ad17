"""The folder of a study: Parquet files of rows, each written under another name and renamed when it is whole.

Every process may add files at any time; none is changed later. What was planned twice, by two processes that did not
know of each other, counts once.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from robotraj._util.errors import InputError
from robotraj._util.paths import input_path
from robotraj._util.system.regular_files import contents
from robotraj._util.system.whole_files import WholeFile, refusals_named
from robotraj.applications.studies.parquet_files import KEY, read_parquet
from robotraj.applications.studies.rows import CASE, CURVES, Row, arrow, schema_of

if TYPE_CHECKING:
    import pyarrow as pa

    from robotraj.applications.studies.cases import Cases

ROWS, SOLUTIONS, CASES, FACTS = "rows", "solutions", "cases.parquet", "study.json"
MOTION = "t", *CURVES
"""Columns of the motion of a row."""
LARGEST_FACTS = 10**6
"""Largest size of the facts [bytes]."""


class Store:
    """A folder with the rows of a study.

    Parameters
    ----------
    folder : path
    create : bool
        Whether to make the folder where there is none.

    Raises
    ------
    InputError
        There is no such study.
    """

    def __init__(self, folder: str | Path, create: bool = False) -> None:
        self.folder = input_path(folder, "The store of the study").absolute()
        with refusals_named(self.folder):
            for name in (ROWS, SOLUTIONS) if create else ():
                (self.folder / name).mkdir(parents=True, exist_ok=True)
            known = (self.folder / ROWS).is_dir()
        self._figures: dict[Path, pa.Table] = {}
        if not known:
            raise InputError(f"{str(folder)!r} is no study: rt.sweep(make, cases, store={str(folder)!r}) makes one.")

    def begin(self, cases: Cases, facts: Mapping[str, object]) -> None:
        """Write the cases of a study, those of an earlier start included where they have the same columns."""
        pa = arrow()
        schema = pa.schema([field for field in schema_of(next(iter(cases.by_key.values()))) if _is_of_case(field.name)])
        rows = [{"key": key, **_prefixed(case)} for key, case in cases.by_key.items()]
        table = pa.Table.from_pylist(rows, schema=schema)
        with refusals_named(self.folder):
            earlier = (self.folder / CASES).exists()
        known = self.cases() if earlier else None
        if known is not None and known.schema.equals(table.schema):
            table = _distinct(pa.concat_tables([table, known]))
        self._write(table, self.folder / CASES)
        with WholeFile(self.folder / FACTS) as partial:
            partial.write_text(json.dumps(facts, indent=1, sort_keys=True))

    def facts(self) -> dict[str, Any]:
        """Return what the study was begun with: digest, options, version."""
        path = self.folder / FACTS
        if not path.exists():
            return {}
        try:
            return dict(json.loads(contents(path, LARGEST_FACTS, "The file of a study")))
        except (ValueError, TypeError, RecursionError) as error:
            raise InputError(f"The file {str(path)!r} of the study is damaged: {str(error)[:200]}.") from error

    def add(self, rows: Sequence[Row], cases: Cases) -> None:
        """Write rows as one file.

        Raises
        ------
        InputError
            The operating system refuses to write, as on a full disk; nothing of it is kept.
        """
        table = arrow().Table.from_pylist(list(rows), schema=schema_of(next(iter(cases.by_key.values()))))
        self._write(table, self.folder / ROWS / f"{uuid4().hex}.parquet")

    def keys(self) -> set[str]:
        """Keys of all rows."""
        return set(self.table(["key"]).column("key").to_pylist())

    def table(self, columns: Sequence[str] | None = None) -> pa.Table:
        """Read the rows, each key once."""
        files = self._files()
        if not files:
            pa = arrow()
            return pa.table({name: pa.array([], pa.string()) for name in columns or ["key"]})
        wanted = None if columns is None else list(dict.fromkeys(["key", *columns]))
        return self._joined([read_parquet(path, wanted, wanted or schema_of({}).names) for path in files])

    def figures(self) -> pa.Table:
        """Read the rows without their motions, each key once; no file is read twice, since none is changed later."""
        needed = [name for name in schema_of({}).names if name not in MOTION]
        self._figures = {
            path: self._figures[path] if path in self._figures else read_parquet(path, needed=needed, without=MOTION)
            for path in self._files()
        }
        return self._joined(list(self._figures.values())) if self._figures else self.table()

    def _joined(self, tables: list[pa.Table]) -> pa.Table:
        pa = arrow()
        try:
            return _distinct(pa.concat_tables(tables, promote_options="permissive"))
        except pa.ArrowException as error:
            raise InputError(f"The files in {str(self.folder / ROWS)!r} are of several studies: {error}.") from error

    def row(self, key: str, columns: Sequence[str]) -> Row | None:
        """Return some columns of the row of a key; None where it has none."""
        for path in self._files():
            known = self._figures[path] if path in self._figures else read_parquet(path, ["key"])
            if key in (keys := known.column("key").to_pylist()):
                rows = read_parquet(path, wanted := ["key", *columns], wanted).select(list(columns))
                return dict(rows.slice(keys.index(key), 1).to_pylist()[0])
        return None

    def columns(self) -> list[str]:
        """Names of the columns of the rows; the key alone before there is one."""
        return (
            list(read_parquet(files[0], needed=schema_of({}).names).column_names)
            if (files := self._files())
            else ["key"]
        )

    def cases(self) -> pa.Table:
        """Read the cases: key and columns."""
        return read_parquet(self.folder / CASES)

    def solution(self, key: str) -> Path:
        """File of the whole solution of a key, which is one of hexadecimal digits."""
        if not KEY.fullmatch(key):
            raise InputError(f"{key[:50]!r} is no key of a study; the column 'key' of its table has them.")
        return self.folder / SOLUTIONS / f"{key}.npz"

    def _files(self) -> list[Path]:
        """Whole files of rows; names of partial ones begin with a dot."""
        return sorted((self.folder / ROWS).glob("[0-9a-f]*.parquet"))

    def _write(self, table: pa.Table, path: Path) -> None:
        import pyarrow.parquet as parquet

        with WholeFile(path) as partial:
            parquet.write_table(table, partial, compression="zstd")


def _prefixed(case: Mapping[str, object]) -> dict[str, object]:
    return {CASE + name: float(value) if type(value) is int else value for name, value in case.items()}


def _is_of_case(name: str) -> bool:
    return name == "key" or name.startswith(CASE)


def _distinct(table: pa.Table) -> pa.Table:
    """Return the rows with the first of each key."""
    first: dict[str, int] = {}
    for number, key in enumerate(table.column("key").to_pylist()):
        first.setdefault(key, number)
    return table if len(first) == table.num_rows else table.take(arrow().array(list(first.values())))
