"""Parquet files of a study, which may be a stranger's: of bounded size, with columns of a study's types alone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import contents
from robotraj.applications.studies.rows import CASE, CURVES, KNOTS, arrow, schema_of

if TYPE_CHECKING:
    import pyarrow as pa

KEY = re.compile("[0-9a-f]{1,128}")
"""A digest of a case; it names the file of its solution."""
LARGEST = 256 * 10**6
"""Largest size of a file, and of its texts when they are unpacked [bytes]."""
SMALL = 10**5
"""Bound of the size of a column's texts below which they are not added up [bytes]."""
MOST_VALUES = 5 * 10**7
"""Most values in a file: a few bytes announce billions of equal ones."""


def read_parquet(
    path: Path,
    columns: Sequence[str] | None = None,
    needed: Sequence[str] = ("key",),
    without: Sequence[str] = (),
) -> pa.Table:
    """Return columns of a file, all by default.

    Parameters
    ----------
    path : Path
    columns : sequence of str, optional
    needed : sequence of str
        Columns that the file must have.
    without : sequence of str
        Columns that are left out.

    Raises
    ------
    InputError
        The file is damaged or too large, or is none of a study.
    """
    pa = arrow()
    import pyarrow.parquet as parquet

    data = pa.BufferReader(contents(path, LARGEST, "The file of a study"))
    try:
        about = parquet.read_metadata(data)
        leaves = [about.schema.column(k) for k in range(about.num_columns)]
        groups = [about.row_group(k) for k in range(about.num_row_groups)]
        values = max(about.num_rows, 1) + sum(
            group.column(k).num_values for group in groups for k in range(about.num_columns)
        )
        if values > MOST_VALUES:
            raise ValueError(f"it has {values} values; {MOST_VALUES} are read")
        # A text that comes again is kept once until all of them are known to be short enough.
        texts = [leaf.path for leaf in leaves if leaf.physical_type == "BYTE_ARRAY"]
        file = parquet.ParquetFile(data, metadata=about, read_dictionary=texts)
        wanted = [name for name in (file.schema_arrow.names if columns is None else columns) if name not in without]
        # Files are small and many: threads for a file's columns would cost more than they save.
        table = file.read(wanted, use_threads=False)
        size = sum(_text_size(column) for column in table.columns)
        if size > LARGEST:
            raise ValueError(f"its texts have {size / 1e6:.0f} MB; {LARGEST / 1e6:.0f} MB are read")
        if absent := [name for name in needed if name not in table.column_names]:
            raise ValueError(f"it has no column {absent[0]!r}")
        return _checked(table.cast(_expected(table.schema)))
    except (pa.ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        reason = " ".join(str(error).split())[:200]
        raise InputError(
            f"The file {str(path)!r} of the study is damaged: {reason}. Its cases are planned again if it is deleted."
        ) from error


def _expected(found: pa.Schema) -> pa.Schema:
    """Return the schema with the types that a study's columns have."""
    pa = arrow()
    known = schema_of({})
    kinds = {pa.bool_(), pa.float64(), pa.string()}
    fields = []
    for field in found:
        if field.name in known.names:
            fields.append(known.field(field.name))
        elif field.name.startswith(CASE) and (kind := _plain(field.type)) in kinds:
            fields.append(pa.field(field.name, kind))
        else:
            raise ValueError(f"the column {field.name[:50]!r} of type {field.type} is none of a study")
    if len(set(found.names)) != len(found.names):
        raise ValueError("it has two columns of one name")
    return pa.schema(fields)


def _checked(table: pa.Table) -> pa.Table:
    """Check the keys, which name files, and the lengths of motions."""
    if any(key is None or not KEY.fullmatch(key) for key in table.column("key").to_pylist()):
        raise ValueError("a key is not one of hexadecimal digits")
    import pyarrow.compute as compute

    for name in {"t", *CURVES} & set(table.column_names):
        if any((length or 0) % KNOTS for length in compute.unique(compute.list_value_length(table[name])).to_pylist()):
            raise ValueError(f"a motion has not {KNOTS} times of {name!r}")
    return table


def _plain(kind: pa.DataType) -> pa.DataType:
    return kind.value_type if arrow().types.is_dictionary(kind) else kind


def _text_size(column: pa.ChunkedArray) -> int:
    """Bytes of the texts of a column, or of its lists of texts, when each is written out, or a bound below SMALL."""
    pa = arrow()
    import pyarrow.compute as compute

    total = 0
    for chunk in column.chunks:
        own = chunk.flatten() if pa.types.is_list(chunk.type) else chunk
        if not pa.types.is_dictionary(own.type):
            continue
        most = len(own) * own.dictionary.nbytes
        if most < SMALL:
            total += most
        else:
            lengths = compute.binary_length(own.dictionary).cast(pa.int64())
            total += compute.sum(lengths.take(own.indices)).as_py() or 0
    return total
