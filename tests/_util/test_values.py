"""``robotraj._util.values.dataclass`` beside the standard library's, on the same classes."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.values import dataclass, own

KINDS = {"standard": dataclasses.dataclass, "shared": dataclass}
both = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS.keys())


def point(kind: Callable[..., Any]) -> Any:
    """Make a class of every sort of field."""

    @kind(frozen=True)
    class Point:
        """A point."""

        x: float
        name: str = field(default="p", compare=False)
        tags: tuple[str, ...] = field(default_factory=tuple, repr=False)
        size: int = field(default=3, kw_only=True)
        double: float = field(init=False, hash=False)

        def __post_init__(self) -> None:
            object.__setattr__(self, "double", 2 * self.x)

        @cached_property
        def triple(self) -> float:
            return 3 * self.x

    return Point


@both
def test_values_print_compare_and_hash(kind: Callable[..., Any]) -> None:
    Point = point(kind)
    one, same, other = Point(1.0, size=4), Point(1.0, "q", size=4), Point(1.0, tags=("a",), size=4)
    assert repr(one).endswith("Point(x=1.0, name='p', size=4, double=2.0)")
    assert one == same
    assert hash(one) == hash(same) == hash((1.0, (), 4))
    assert one != other
    assert one != (1.0, (), 4, 2.0)
    assert one.triple == 3.0


def test_classes_look_alike_from_outside() -> None:
    standard, shared = point(dataclasses.dataclass), point(dataclass)
    assert str(inspect.signature(shared)) == str(inspect.signature(standard))
    assert shared.__match_args__ == standard.__match_args__
    assert [f.name for f in dataclasses.fields(shared)] == [f.name for f in dataclasses.fields(standard)]
    assert repr(shared.__dataclass_params__) == repr(standard.__dataclass_params__)
    assert hash(shared(2.0)) == hash(standard(2.0))


@both
def test_nothing_is_set_or_deleted_later(kind: Callable[..., Any]) -> None:
    value = point(kind)(1.0)
    for name in ("x", "size", "double", "unknown"):
        with pytest.raises(dataclasses.FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(value, name, 5.0)
        with pytest.raises(dataclasses.FrozenInstanceError, match=f"cannot delete field '{name}'"):
            delattr(value, name)
    assert value.x == 1.0


@both
def test_replace_copies_and_checks_again(kind: Callable[..., Any]) -> None:
    moved = dataclasses.replace(point(kind)(1.0, tags=("a",)), x=4.0)
    assert (moved.x, moved.double, moved.tags) == (4.0, 8.0, ("a",))
    assert copy.deepcopy(moved) == moved


@both
@pytest.mark.parametrize("over", KINDS.values(), ids=KINDS.keys())
def test_subclasses_of_either_kind(kind: Callable[..., Any], over: Callable[..., Any]) -> None:
    Point = point(kind)

    @over(frozen=True)
    class Named(Point):
        """A point with one more field."""

        colour: str = "red"

    value = Named(1.0, colour="blue")
    assert repr(value).endswith("Named(x=1.0, name='p', size=3, double=2.0, colour='blue')")
    assert value != Point(1.0)
    assert value == Named(1.0, colour="blue")
    with pytest.raises(dataclasses.FrozenInstanceError):
        value.colour = "red"
    with pytest.raises(dataclasses.FrozenInstanceError):
        value.x = 2.0
    with pytest.raises(TypeError, match="cannot inherit non-frozen dataclass from a frozen one"):
        over(type("Loose", (Point,), {"__annotations__": {}}))


@both
def test_a_plain_subclass_may_hold_more(kind: Callable[..., Any]) -> None:
    class Plain(point(kind)):
        """Not a dataclass."""

    value = Plain(1.0)
    value.note = "here"
    del value.note
    with pytest.raises(dataclasses.FrozenInstanceError):
        value.x = 2.0


@both
def test_what_a_class_defines_is_kept(kind: Callable[..., Any]) -> None:
    @kind(frozen=True)
    class Own:
        """Defines its own ``__repr__`` and ``__eq__``."""

        x: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return True

    @kind(frozen=True)
    class Hashed:
        """Defines its own ``__hash__``."""

        x: int

        def __hash__(self) -> int:
            return 7

    assert repr(Own(1)) == "own"
    assert Own(1) == Own(2)
    assert hash(Own(1)) == hash((1,))
    assert hash(Hashed(1)) == 7


@both
def test_options_choose_the_generated_methods(kind: Callable[..., Any]) -> None:
    @kind(frozen=True, eq=False, repr=False)
    class Same:
        """Equal to itself only."""

        x: int

    @kind
    class Loose:
        """May be changed."""

        x: int
        inside: list[Any] = field(default_factory=list)

    @kind(frozen=True, init=False)
    class Made:
        """Defines its own ``__init__``."""

        x: int

        def __init__(self) -> None:
            object.__setattr__(self, "x", 5)

    assert Same(1) != Same(1)
    assert hash(Same(1)) is not None
    assert repr(Same(1)).startswith("<")
    loose = Loose(1)
    loose.x = 2
    loose.inside.append(loose)
    assert repr(loose).endswith("Loose(x=2, inside=[...])")
    assert Loose(2) == Loose(2)
    with pytest.raises(TypeError, match="unhashable"):
        hash(loose)
    assert repr(Made()).endswith("Made(x=5)")


@dataclass(frozen=True)
class Pickled:
    """At the head of a module, where pickles look for it."""

    x: float
    y: tuple[int, ...] = ()


def test_pickles_and_patterns() -> None:
    value = pickle.loads(pickle.dumps(Pickled(2.0, (1, 2))))
    assert value == Pickled(2.0, (1, 2))
    match value:
        case Pickled(x, (_, last)):
            assert (x, last) == (2.0, 2)
        case _:
            pytest.fail("no match")


def test_own_copies_share_no_array_list_or_dict() -> None:
    inner = np.array([1.0, 2.0])
    given = {"a": [inner, (inner, None)], "b": "text", "c": abs}
    kept = own(given)
    inner[0], given["a"], given["b"] = 9.0, [], ""
    assert kept["a"][0].tolist() == kept["a"][1][0].tolist() == [1.0, 2.0]
    assert kept["b"] == "text" and kept["c"] is abs
    with pytest.raises(ValueError, match="read-only"):
        kept["a"][0][0] = 3.0


def test_a_refused_change_names_what_makes_a_changed_copy() -> None:
    robot = rt.load("pendulum")
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"'velocity' of Limits.*value\.with_\(velocity=\.\.\.\)"):
        robot.limits.velocity = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"'duration' of Phase.*value\.with_\(duration=\.\.\.\)"):
        rt.Phase(robot, 1.0).duration = 2.0
    with pytest.raises(dataclasses.FrozenInstanceError, match=r"dataclasses\.replace\(value, q=\.\.\.\)"):
        rt.State(q=0).q = 1.0
