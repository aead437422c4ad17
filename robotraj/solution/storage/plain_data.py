"""Plain data: what ``packing`` writes and ``unpacking`` reads, as JSON and arrays.

Floats are kept bit for bit: JSON has the shortest text that reads back as the same number, and arrays are binary.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from robotraj._util.errors import InputError

MARK = "$"
"""First character of keys that name a kind of value; mappings of users may not have such keys."""

Json: TypeAlias = Any
"""JSON as ``json.loads`` returns it; its readers check it entry by entry."""


class NotPlainData(InputError):
    """A value that a file cannot hold, or one of a class that is not made from files; the message names it."""


class Damaged(InputError):
    """Data that no ``Packer`` wrote; the message names the place."""
