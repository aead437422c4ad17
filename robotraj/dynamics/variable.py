"""A named scalar of the optimal control problem, and the named vectors that users index."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from textwrap import shorten
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import unknown_name
from robotraj._util.printing import WIDTH, OneLine, brief
from robotraj._util.values import dataclass

if TYPE_CHECKING:
    import casadi as ca

Scalar: TypeAlias = "ca.SX | float"
"""An expression of symbols in the NLP, a number in the witness."""
Column: TypeAlias = "ca.SX | NDArray[np.float64]"
"""A vector or matrix of expressions or numbers."""
Entry = TypeVar("Entry", covariant=True)
"""What one name of a ``Named`` stands for: a scalar, its values at several times, or the force of a contact."""


@dataclass(frozen=True)
class Variable(OneLine):
    """One scalar state, algebraic variable, control or residual row.

    Attributes
    ----------
    name : str
        Unique within its vector, for example ``"q.elbow"``.
    unit : str
        SI unit, ``""`` when unknown.
    quantity : str
        Physical quantity: ``"position"``, ``"velocity"``, ``"effort"``, ``"state"`` ...
    joint : str or None
        The joint it belongs to, if it belongs to one.
    """

    name: str
    unit: str = ""
    quantity: str = "variable"
    joint: str | None = None

    @property
    def label(self) -> str:
        """The joint's name where there is one, else the variable's."""
        return self.joint if self.joint is not None else self.name


class Named(Mapping[str, Entry]):
    """A vector read by name: ``point.x["v"]``; an unknown name raises an error that lists the valid ones.

    Parameters
    ----------
    kind : str
        Kind of the entries, for messages: ``"state"``, ``"control"`` ...
    names : sequence of str
        One name an entry.
    values : sequence of len(names) or None
        A CasADi column, a NumPy array or a sequence; None where the entries are not known, at the ends of a phase.
    """

    def __init__(self, kind: str, names: Sequence[str], values: Column | Sequence[Entry] | None) -> None:
        self.kind = kind
        self._index = {name: i for i, name in enumerate(names)}
        self._values = values

    @property
    def column(self) -> Column | Sequence[Entry] | None:
        """All entries, as passed to the constructor."""
        return self._values

    def __getitem__(self, name: str) -> Entry:
        if name not in self._index or self._values is None:
            # Points at the ends of a phase, for links and Mayer terms, have neither controls nor algebraic variables.
            advice = "The ends of a phase have only times, states and parameters." if self._values is None else ""
            raise unknown_name(self.kind, name, self._index, advice)
        return self._values[self._index[name]]

    def __contains__(self, name: object) -> bool:
        return name in self._index

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def __repr__(self) -> str:
        entries = (f"{name}: {brief(value)}" for name, value in self.items())
        return "{" + shorten(", ".join(entries), WIDTH - 2, placeholder=" ...") + "}"
