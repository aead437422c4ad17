"""Cached values stay with the instance that computed them."""

from __future__ import annotations

import copy
import pickle
from dataclasses import dataclass as standard_dataclass
from threading import Lock

import pytest

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class Ours:
    number: float

    @cached_property
    def lock(self) -> object:
        return Lock()


@standard_dataclass(frozen=True)
class Standard(Ours):
    other: float = 2.0


class Plain(Ours):
    pass


@pytest.mark.parametrize("value", [Ours(1.0), Standard(1.0), Plain(1.0)], ids=lambda value: type(value).__name__)
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_a_copy_has_the_fields_and_no_cached_value(value: Ours, copied) -> None:
    known = value.lock
    other = copied(value)
    assert other == value and type(other) is type(value)
    assert other.lock is not known and value.lock is known


class Own(Ours):
    def __getstate__(self) -> dict[str, object]:
        return {"number": -1.0}


def test_a_class_may_decide_what_its_copies_hold() -> None:
    assert copy.copy(Own(1.0)).number == -1.0
