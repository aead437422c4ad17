"""The entries of a file, read without trust: sizes are compared with limits before anything is unpacked."""

from __future__ import annotations

import zipfile
import zlib
from io import BytesIO
from math import prod
from pathlib import Path
from tokenize import TokenError

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError

MOST_BYTES = 512 * 2**20
"""Largest size of all entries, unpacked [bytes]."""

MOST_ENTRIES = 20_000
"""Largest number of entries."""

KINDS = "biufU"
"""Kinds of numbers, and text, that an entry may hold."""


LONGEST = 200
"""Characters that are kept of another library's message, which may contain the bytes of a damaged file."""


class Unreadable(InputError):
    """An entry that is damaged or too large; the message names it."""


def read_entries(source: Path) -> dict[str, NDArray[np.generic]]:
    """Read all arrays of an ``.npz`` file.

    Raises
    ------
    Unreadable
        The file is no archive, an entry is damaged or no plain array, or the sizes exceed the limits.
    OSError
        The operating system cannot read the file.
    """
    try:
        with zipfile.ZipFile(source) as archive:
            infos = archive.infolist()
            size = sum(info.file_size for info in infos)
            if len(infos) > MOST_ENTRIES or size > MOST_BYTES:
                raise Unreadable(
                    f"it has {len(infos)} entries of {size} bytes unpacked; at most {MOST_ENTRIES} entries and "
                    f"{MOST_BYTES} bytes are read"
                )
            return {info.filename.removesuffix(".npy"): _entry(archive, info) for info in infos}
    except (zipfile.BadZipFile, zlib.error, EOFError, ValueError, NotImplementedError, RuntimeError) as error:
        if isinstance(error, Unreadable):
            raise
        raise Unreadable(f"it is no whole archive: {str(error)[:LONGEST]}") from error


def _entry(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> NDArray[np.generic]:
    try:
        # No more is unpacked than the entry claims.
        with archive.open(info) as file:
            return _array(file.read(info.file_size))
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        SyntaxError,
        TokenError,
        TypeError,
        ValueError,
        OverflowError,
        MemoryError,
        RecursionError,
        NotImplementedError,
        RuntimeError,
    ) as error:
        raise Unreadable(f"its entry {info.filename[:80]!r} is damaged: {str(error)[:LONGEST]}") from error


def _array(data: bytes) -> NDArray[np.generic]:
    """Read an ``.npy`` file whose header claims exactly the numbers that follow it."""
    file = BytesIO(data)
    version = np.lib.format.read_magic(file)
    read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}.get(version)
    if read is None:
        raise ValueError(f"version {version} of its format is not read")
    shape, by_columns, dtype = read(file)
    if dtype.kind not in KINDS or dtype.hasobject:
        raise ValueError(f"it holds {dtype}, no plain numbers")
    rest = data[file.tell() :]
    if any(n < 0 for n in shape) or prod(shape) * dtype.itemsize != len(rest):
        raise ValueError(f"its header claims the shape {shape}, but {len(rest)} bytes follow")
    array = np.frombuffer(rest, dtype=dtype) if rest else np.empty(0, dtype)
    return array.reshape(shape, order="F" if by_columns else "C").copy()
