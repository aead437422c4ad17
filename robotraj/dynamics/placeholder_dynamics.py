"""Placeholder for the equations of a System that was loaded from a file; files store no Python functions."""

from __future__ import annotations

from typing import NoReturn

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point


@dataclass(frozen=True)
class MissingEquations:
    """Placeholder for the equations of a System; calling it raises an error that names the remedy.

    Attributes
    ----------
    system : str
        Name of the system.
    """

    system: str

    def __call__(self, point: Point) -> NoReturn:
        """Raise InputError."""
        raise InputError(
            f"The equations of system {self.system!r} are Python functions, which a file does not hold; "
            "load it with rt.load_solution(path, problem=...) to have them."
        )
