"""Pickles of values with a ``model`` whose joints may follow others.

Pinocchio 4.1 saves mimic joints, but a restored one ends the process at its first use.
"""

from __future__ import annotations

from typing import Any

from robotraj._util.lazy_values import without_cached_values
from robotraj.robot.coupling.coupled_model import coupled, uncoupled
from robotraj.robot.coupling.mimics import mimics_of


class PickledModel:
    """Base class of values with an attribute ``model``, pickled as independent joints and their couplings."""

    def __getstate__(self) -> dict[str, Any]:
        """Replace the model by its independent joints and their couplings."""
        state = without_cached_values(self)
        mimics = mimics_of(state["model"])
        return state | {"model": uncoupled(state["model"]), "couplings": mimics} if mimics else state

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Couple the joints of the model."""
        mimics = state.pop("couplings", ())
        self.__dict__.update(state | {"model": coupled(state["model"], mimics)})
