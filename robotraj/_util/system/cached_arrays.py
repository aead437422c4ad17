"""Arrays in files of a cache: read without trust, and written where the disk allows it."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.system.whole_files import WholeFile

Arrays = Mapping[str, NDArray[np.generic]]


def packed_arrays(arrays: Arrays) -> bytes:
    """Return arrays by name as the bytes of an npz file."""
    stream = io.BytesIO()
    np.savez(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


def unpacked_arrays(data: bytes) -> Arrays:
    """Return what ``packed_arrays`` packed.

    Raises
    ------
    ValueError
        The bytes are damaged.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except ValueError:
        raise
    except Exception as error:  # zip files raise what their parts raise
        raise ValueError(f"damaged: {error}") from error


def keep(path: Path, data: bytes) -> None:
    """Write a file of a cache; where that is refused, the next process computes its content again."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with WholeFile(path) as partial:
            partial.write_bytes(data)
    except (OSError, InputError):
        pass
