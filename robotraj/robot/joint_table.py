"""A robot's joints as a table, in text and in HTML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.printing import WIDTH, table, wrapped
from robotraj.robot.limits import RATES, Limits

UNITS = "velocity in unit/s, effort in N m (rad) or N (m), damping in effort per velocity"
ALWAYS = ("velocity", "effort")
"""Rates that have a column in every table."""
LEFT = "'text-align:left'"


class Joints(NamedTuple):
    """Columns of the table, in the order of the velocities.

    Attributes
    ----------
    names, units : sequence of str
    limits : Limits
    motors : sequence of bool
    damping, friction : (nv,) [N m s/rad, N s/m], [N m, N]
    neutral : (nv,) [rad, m]
        NaN where the position is part of a quaternion.
    """

    names: Sequence[str]
    units: Sequence[str]
    limits: Limits
    motors: Sequence[bool]
    damping: NDArray[np.float64]
    friction: NDArray[np.float64]
    neutral: NDArray[np.float64]


def number(value: float, unit: str = "") -> str:
    """Write a number with its unit, or ``-`` if it is not finite."""
    return f"{value:.4g} {unit}".strip() if np.isfinite(value) else "-"


def interval(low: float, high: float, unit: str = "") -> str:
    """Write two limits as ``[-1, 2]``, or as a number where they are a magnitude; ``-`` if there are none."""
    if np.isinf(low) and np.isinf(high):
        return "-"
    return (f"{high:.4g}" if low == -high else f"[{low:.4g}, {high:.4g}]") + unit


def _positions(low: float, high: float) -> str:
    return "-" if np.isinf(low) and np.isinf(high) else f"[{low:.4g}, {high:.4g}]"


def joint_rows(joints: Joints) -> list[tuple[str, ...]]:
    """Return the cells of the table, headings first; a missing limit is ``-``.

    Rates have the joint's unit per second. Limits of acceleration and jerk, damping and friction have a column only
    if a joint has one.
    """
    limits = joints.limits
    columns: list[tuple[str, Sequence[str]]] = [
        ("joint", joints.names),
        ("unit", joints.units),
        ("position", [_positions(*ends) for ends in zip(*limits.sides("position"), strict=True)]),
    ]
    for name in RATES:
        if name in ALWAYS or np.any(np.isfinite(limits.sides(name))):
            columns.append((name, [interval(*ends) for ends in zip(*limits.sides(name), strict=True)]))
    columns += [
        ("motor", ["yes" if motor else "no" for motor in joints.motors]),
    ]
    for name, values in (("damping", joints.damping), ("friction", joints.friction)):
        if np.any(values):
            columns.append((name, [number(value) for value in values]))
    columns.append(("neutral", [number(value) for value in joints.neutral]))
    headings, cells = zip(*columns, strict=True)
    return [tuple(headings), *zip(*cells, strict=True)]


def joint_table(joints: Joints) -> list[str]:
    """Return the table as lines of at most 80 characters, one joint a line where its cells fit.

    Where the table is wider, columns with one value for all joints become a line below it.
    """
    columns = list(zip(*joint_rows(joints), strict=True))
    alike = [i for i, (_, *cells) in enumerate(columns) if i and len(set(cells)) == 1]
    if len(joints.names) < 2 or sum(max(map(len, column)) + 2 for column in columns) - 2 <= WIDTH:
        alike = []
    kept = [column for i, column in enumerate(columns) if i not in alike]
    common = ", ".join(f"{columns[i][0]} {columns[i][1]}" for i in alike)
    return [*table(zip(*kept, strict=True)), *(wrapped(f"all joints: {common}") if common else []), UNITS]


def joint_html(joints: Joints) -> str:
    """Return the table as HTML."""
    head, *rows = ([escape(cell) for cell in row] for row in joint_rows(joints))
    body = "".join(f"<tr>{''.join(f'<td style={LEFT}>{cell}</td>' for cell in row)}</tr>" for row in rows)
    headings = "".join(f"<th style={LEFT}>{cell}</th>" for cell in head)
    return f"<table><thead><tr>{headings}</tr></thead><tbody>{body}</tbody></table><p>{UNITS}</p>"
