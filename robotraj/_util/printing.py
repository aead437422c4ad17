"""Values printed as the calls that make them."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass


def as_call(value: object) -> str:
    """Print a value with the fields that differ from their defaults: ``BernsteinBounds(controls=True)``.

    A dataclass with a ``__str__`` of its own prints by that. Values that are not dataclasses print by ``repr``.
    """
    if isinstance(value, tuple | list):
        return f"({', '.join(map(as_call, value))}{',' if len(value) == 1 else ''})"
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    if type(value).__str__ is not object.__str__:
        return str(value)
    parts = []
    for entry in fields(value):
        given = getattr(value, entry.name)
        default = entry.default if entry.default_factory is MISSING else entry.default_factory()
        if entry.repr and given != default:
            parts.append(f"{entry.name}={as_call(given)}")
    return f"{type(value).__name__}({', '.join(parts)})"
