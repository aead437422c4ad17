"""Values drawn from bytes, so that a fuzzer which changes bytes changes values."""

from __future__ import annotations

import struct

import numpy as np

SPECIAL = (0.0, -0.0, 1.0, np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 1e-300, 1e20, -1e9, 1e6, np.pi)
WILD = (-1, -(2**31), 2**31 - 1, 2**32, 2**62, -(2**63), 10**6)


class Draws:
    """Draws from bytes; after their end every byte is zero.

    Parameters
    ----------
    data : bytes
    """

    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, 0

    def take(self, count: int) -> bytes:
        """Return the next bytes."""
        found = self._data[self._at : self._at + count]
        self._at += count
        return found.ljust(count, b"\0")

    def rest(self) -> bytes:
        """Return all that are left."""
        found = self._data[self._at :]
        self._at = len(self._data)
        return found

    def below(self, count: int) -> int:
        """Return an integer of 0 .. count - 1, for counts up to 256."""
        return self.take(1)[0] % max(1, count)

    def rare(self) -> bool:
        """True once in 32 bytes that differ, and never after the end."""
        return self.take(1)[0] % 32 == 31

    def number(self) -> float:
        """Return a number, mostly a small one."""
        kind = self.below(8)
        if kind < 6:
            return (self.take(1)[0] - 128) / 32.0
        if kind == 6:
            return SPECIAL[self.below(len(SPECIAL))]
        return float(struct.unpack("<d", self.take(8))[0])

    def length(self, right: int) -> int:
        """Return a length of an array, rarely a wrong one."""
        return max(0, right + self.below(16) - 8) if self.rare() else right

    def numbers(self, count: int) -> np.ndarray:
        """Return (count,) numbers."""
        return np.array([self.number() for _ in range(self.length(count))], dtype=float)

    def index(self, first: int, end: int) -> int:
        """Return an integer of first .. end - 1, rarely one outside."""
        return WILD[self.below(len(WILD))] if self.rare() else first + self.below(end - first)

    def indices(self, count: int, first: int, end: int, dtype: type = np.int64) -> np.ndarray:
        """Return (count,) integers of first .. end - 1."""
        found = [self.index(first, end) for _ in range(self.length(count))]
        return np.array(found, dtype=np.int64).astype(dtype)

    def ascending(self, count: int, end: int, dtype: type = np.int64) -> np.ndarray:
        """Return (count,) integers of 0 .. end - 1 that ascend, but for rare ones."""
        found = np.sort([self.below(end) for _ in range(self.length(count))]).astype(np.int64)
        if found.size and self.rare():
            found[self.below(found.size)] = WILD[self.below(len(WILD))]
        return found.astype(dtype)
