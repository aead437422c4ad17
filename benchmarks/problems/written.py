"""Cases written as equations in YAML files.

``rhs``, ``lagrange``, ``mayer``, ``path`` and ``at_end`` are Python expressions of states, controls and parameters by
name. They may call sin, cos, tan, exp and sqrt, and use pi. ``mayer`` also knows the duration T and the last states,
``x_f``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import yaml

import robotraj as rt

from .case import Case

TABLE = Path(__file__).parents[2] / "tests" / "cases" / "systems.yaml"
MORE = Path(__file__).parent / "more.yaml"
FUNCTIONS = {"pi": np.pi} | {name: getattr(ca, name) for name in ("sin", "cos", "tan", "exp", "sqrt", "fabs")}


def written(path: Path) -> Iterator[Case]:
    """Every case of a file."""
    for entry in yaml.safe_load(path.read_text()):
        yield case_of(entry)


def case_of(entry: Mapping[str, Any]) -> Case:
    """One entry as a phase with its guess and optimum."""
    guess = entry["guess"]
    states = [state(row) for row in guess["x"]]
    start = rt.guess.Keyframes(guess.get("s", [0, 1]), states, duration=guess.get("T"))
    return Case(entry["id"], phase_of(entry), start, number(entry["exact"]), entry["accuracy"], entry["source"])


def phase_of(entry: Mapping[str, Any]) -> rt.Phase:
    """Read the equations, bounds, rows and cost of an entry."""

    def known(point: Any) -> dict[str, Any]:
        names = {**FUNCTIONS, **entry.get("params", {}), **dict(point.x), **dict(point.u), "t": point.t}
        for name, text in entry.get("let", {}).items():
            names[name] = eval(text, names)
        return names

    def along(text: str) -> Callable[[Any], Any]:
        return lambda point: eval(text, known(point))

    def rates(point: Any) -> list[Any]:
        names = known(point)
        return [eval(str(text), names) for text in entry["rhs"]]

    def last(start: Any, end: Any) -> Any:
        names = {f"{name}_f": value for name, value in end.x.items()}
        return eval(entry["mayer"], FUNCTIONS | entry.get("params", {}) | names | {"T": end.t - start.t})

    objective = rt.Mayer(last) if "mayer" in entry else rt.Lagrange(along(entry["lagrange"]))
    if entry.get("mayer") == "T":
        objective = rt.Duration()
    path = entry.get("path", {})
    path = {path: [0, 0]} if isinstance(path, str) else path
    rows = [rt.PathConstraint(along(text), *map(number, limits), name=text) for text, limits in path.items()]
    rows += [
        rt.AtEnd(rt.PathConstraint(along(text), *map(number, limits), name=text))
        for text, limits in entry.get("at_end", {}).items()
    ]
    rows += [
        rt.constraints.IntegralConstraint(along(text), *map(number, limits), name=text)
        for text, limits in entry.get("integral", {}).items()
    ]
    duration = entry["T"]
    return rt.Phase(
        rt.System(entry["states"], entry["controls"], rates, name=entry["id"]),
        tuple(map(number, duration)) if isinstance(duration, list) else number(duration),
        state(entry["initial"]),
        state(entry["final"]),
        objective,
        rows,
        states=bounds(entry["states"], entry.get("state_bounds")),
        controls=bounds(entry["controls"], entry.get("control_bounds")),
        name=entry["id"],
    )


def number(value: Any) -> Any:
    """Read a number, None, or the value of an expression such as ``2*pi``."""
    return float(eval(value, {"pi": np.pi, "sin": np.sin, "sqrt": np.sqrt})) if isinstance(value, str) else value


def state(row: list[Any]) -> rt.State:
    """Read a row of values, null where free."""
    return rt.State([number(value) for value in row])


def bounds(names: list[str], rows: list[Any] | None) -> dict[str, Any]:
    """Pairs of bounds by name."""
    pairs = zip(names, rows or [None] * len(names), strict=True)
    return {name: rt.between(*map(number, row)) for name, row in pairs if row is not None}
