"""Errors of whole values, such as a phase, are traced to the key that causes them."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from robotraj._util.errors import InputError, UnknownName
from robotraj.applications.problem_files.lines import Data, KeyPath, Misplaced

SECONDS = 2.0
"""Processor time after which no smaller place is searched for."""

LABELS = ("name", "type", "robot")
"""Keys whose values are quoted in messages about something else."""

T = TypeVar("T")


def narrowed(make: Callable[[Data], T], data: Data, place: KeyPath) -> T:
    """Make a value from data; an error names the smallest part of the data that causes it.

    A part causes an error if its text is an unknown name or the message mentions its key. It also does if the value can
    be made without it.

    Raises
    ------
    Misplaced
        In place of an InputError, a TypeError or a ValueError.
    """
    try:
        return make(data)
    except Misplaced:
        raise
    except (InputError, TypeError, ValueError) as error:
        message = str(error)
        # The near names that follow exist, and stand in the data elsewhere.
        unknown = _quoted(data, message.partition(" Did you mean")[0]) if isinstance(error, UnknownName) else ()
        cause = unknown or _removable(make, data) or _mentioned(data, message) or _quoted(data, message)
        raise Misplaced((*place, *cause), message) from error


def _quoted(data: Data, message: str) -> KeyPath:
    """Return the first key or text that the message quotes."""
    quoted = set(re.findall(r"'([^']+)'", message))
    for place, value in _leaves(data):
        if place and place[-1] not in LABELS and ((isinstance(value, str) and value in quoted) or place[-1] in quoted):
            return place
    return ()


def _removable(make: Callable[[Data], object], data: Data) -> KeyPath:
    """Return the innermost part without which the value can be made."""
    place: KeyPath = ()
    began = time.process_time()
    part = data
    while isinstance(part, dict | list):
        keys = list(part) if isinstance(part, dict) else [i for i, each in enumerate(part) if isinstance(each, dict)]
        for key in keys:
            if time.process_time() - began > SECONDS:
                return place
            if key not in LABELS and _can_be_made(make, _without(data, (*place, key))):
                place, part = (*place, key), part[key]
                break
        else:
            return place
    return place


def _can_be_made(make: Callable[[Data], object], data: Data) -> bool:
    try:
        make(data)
    except (InputError, TypeError, ValueError):
        return False
    return True


def _mentioned(data: Data, message: str) -> KeyPath:
    """Return the first key that the message mentions as a word."""
    words = set(re.findall(r"\w+", message))
    keys = [key for key in data if key in words and key not in LABELS] if isinstance(data, dict) else []
    return (keys[0],) if keys else ()


def _leaves(data: Data, place: KeyPath = ()) -> Iterator[tuple[KeyPath, Data]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, (*place, key))
    elif isinstance(data, list):
        for number, value in enumerate(data):
            yield from _leaves(value, (*place, number))
    else:
        yield place, data


def _without(data: Data, place: KeyPath) -> Data:
    """Return a copy of data that lacks one part."""
    key, rest = place[0], place[1:]
    if isinstance(data, list):
        if not rest:
            return [each for i, each in enumerate(data) if i != key]
        return [_without(each, rest) if i == key else each for i, each in enumerate(data)]
    if not rest:
        return {name: each for name, each in data.items() if name != key}
    return {name: _without(each, rest) if name == key else each for name, each in data.items()}
