"""Calls of public functions and classes in which one argument is hostile, and the others are good."""

from __future__ import annotations

import inspect
import random
from collections.abc import Callable, Iterator
from enum import Enum
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin

import robotraj as rt

VALUES: tuple[Any, ...] = (
    *(None, True, 0, -1, 3, 10**30, 2**63, -0.5, float("nan"), float("inf"), 1e308, 5e-324, 1j, Fraction(1, 3)),
    *("", "a", "\0", "\u202eevil", "\ud800", "x" * 100_000, "../../etc/passwd", b"abc"),
    *([], (), {}, set(), [None], [[]], [0] * 7, [float("nan")] * 3, {"a": 1}, {None: 1}, range(5)),
    *(np.zeros(0), np.zeros((0, 3)), np.full(3, np.nan), np.zeros((3, 3, 3)), np.array("a"), np.array([None, 1])),
    *(object(), object, abs, Path("/nowhere/x"), inspect, Ellipsis, slice(None), np.ma.masked, Exception("x")),
    *(ca.SX.sym("x"), ca.MX.sym("x", 2), ca.DM([1, 2]), pin.SE3.Identity(), pin.Model()),
    *(rt.Effort, rt.Effort(), rt.Duration(), rt.State(q=0), rt.Mesh(3), rt.between(0, 1), rt.obstacles.Sphere(0.1)),
)
"""What is put in the place of an argument."""
SLOW = ("rt.sweep", "rt.multistart", "rt.share_cell", "rt.Study", "rt.witness.disturbance_margin")
"""Calls that take seconds, or start processes, where the other arguments are good."""


class Calls:
    """Public calls, and good values of their arguments."""

    def __init__(self) -> None:
        pendulum, hopper = rt.load("pendulum"), rt.load("monopod")
        phase = rt.Phase(pendulum, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
        solution = rt.plan(phase, mesh=rt.Mesh(4), check=False)
        self._good: dict[str, list[Any]] = {
            "Robot": [pendulum, hopper],
            "Phase": [phase],
            "Problem": [rt.Problem([phase]), phase],
            "Solution": [solution],
            "Dynamics": [pendulum, phase.dae],
            "Mesh": [rt.Mesh(3)],
            "Solver": [rt.InteriorPoint(max_iterations=5)],
            "float": [0.1, 1.0],
            "int": [1, 3],
            "bool": [False],
            "Callable": [lambda point: point.t],
            "str": ["tip", "foot", "joint"],
            "Sequence": [[0.0, 0.0, 1.0], [0.0], ["foot"]],
        }
        self.called = [*self._public(), *self._methods(solution, pendulum, phase, pendulum.limits, rt.HermiteSimpson())]

    def draw(self, number: int) -> tuple[str, Callable[[], object]]:
        """Return the text of a call, and a function that makes it."""
        chance = random.Random(number)
        name, function = self.called[number % len(self.called)]
        parameters = list(inspect.signature(function).parameters.values())
        hostile = chance.choice(parameters).name if parameters else ""
        given: list[Any] = []
        named: dict[str, Any] = {}
        for each in parameters:
            if each.kind is each.VAR_KEYWORD or (each.name != hostile and each.default is not each.empty):
                continue
            value = chance.choice(VALUES) if each.name == hostile else self._value(each, chance)
            if each.kind in (each.POSITIONAL_ONLY, each.VAR_POSITIONAL):
                given.append(value)
            else:
                named[each.name] = value
        text = ", ".join([*map(_short, given), *(f"{key}={_short(value)}" for key, value in named.items())])
        return f"{name}({text})", lambda: function(*given, **named)

    def _value(self, parameter: inspect.Parameter, chance: random.Random) -> object:
        for kind, values in self._good.items():
            if kind in str(parameter.annotation):
                return chance.choice(values)
        return chance.choice([0.5, "a", [0.0, 0.0, 1.0]])

    @staticmethod
    def _public() -> Iterator[tuple[str, Callable[..., Any]]]:
        rooms = [name for name in rt.__all__ if isinstance(getattr(rt, name), ModuleType)]
        seen: set[int] = set()
        for prefix in ("", *rooms):
            module = getattr(rt, prefix) if prefix else rt
            for name in module.__all__:
                found = getattr(module, name)
                label = f"rt.{prefix}.{name}" if prefix else f"rt.{name}"
                if (
                    (isinstance(found, type) or inspect.isroutine(found))
                    and id(found) not in seen
                    and label not in SLOW
                    and not _no_call(found)
                ):
                    seen.add(id(found))
                    yield label, found

    @staticmethod
    def _methods(*values: object) -> Iterator[tuple[str, Callable[..., Any]]]:
        for value in values:
            for name, found in inspect.getmembers(value, inspect.isroutine):
                if not name.startswith("_") and name not in ("plot", "show"):
                    yield f"{type(value).__name__}.{name}", found


def fault(number: int, calls: Calls) -> str:
    """Make one call, and return what was wrong with its end; empty where it returned, or was refused in plain words."""
    text, call = calls.draw(number)
    try:
        call()
    except rt.RobotrajError as error:
        return "" if 0 < len(str(error)) < 5_000 else f"{text}: {len(str(error))} letters"
    except Exception as error:
        return f"{text}: {type(error).__name__}: {error}"
    return ""


def _no_call(found: object) -> bool:
    """Whether a class is abstract, an enumeration or an error, which users do not make."""
    if not isinstance(found, type):
        return False
    return inspect.isabstract(found) or getattr(found, "_is_protocol", False) or issubclass(found, Enum | BaseException)


def _short(value: object) -> str:
    return repr(value)[:60]
