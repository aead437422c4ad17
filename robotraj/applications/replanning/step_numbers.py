"""The numbers that a step of a control loop changes, from its states and parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj.problem.state import State
from robotraj.transcription.nlp import Nlp

PARAMETERS = 2
"""Number of scalars of a phase before its parameters: start time and duration."""


class StepNumbers:
    """Fixed values of both ends, start time and fixed parameters of a phase; each stays until it is changed.

    Attributes
    ----------
    columns : ndarray of int (m,)
        Columns of the fixed values of the ends.
    scalars : tuple of int
        Places of the start time and of the fixed parameters among the scalars of the phase.
    """

    def __init__(self, nlp: Nlp) -> None:
        layout, variables, phase = nlp.layouts[0], nlp.variables, nlp.problem.phases[0]
        bounds = phase.start_bounds, phase.end_bounds
        self._phase = phase
        self._fixed = [np.flatnonzero(given.lower == given.upper) for given in bounds]
        loose = [state.name for i, state in enumerate(phase.body.states) if i not in self._fixed[0]]
        if loose:
            raise InputError(f"A Replanner needs a fixed start, but that of {phase.name!r} leaves {loose[0]!r} open.")
        columns = np.concatenate([layout.knots[k][own] for k, own in zip((0, -1), self._fixed, strict=True)])
        # A value that exceeds a limit by round-off has distinct bounds and is not a fixed column.
        self._kept = variables.lower[columns] == variables.upper[columns]
        self.columns = columns[self._kept]
        self._names = [n for n, s in zip(phase.parameter_names, layout.parameters, strict=True) if s.column is None]
        self.scalars = (0, *(PARAMETERS + phase.parameter_names.index(name) for name in self._names))
        self._ends = [given.lower[own] for given, own in zip(bounds, self._fixed, strict=True)]
        self._parameters = {n: s.value for n, s in zip(phase.parameter_names, layout.parameters, strict=True)}

    def values(self, t: float, start: State, end: State | None, parameters: Mapping[str, float]) -> Array:
        """Return the numbers of a step: fixed columns, start time [s], parameters."""
        for which, (name, state) in enumerate((("start", start), ("end", end))):
            if state is not None:
                self._ends[which] = self._read(which, name, state)
        for name, value in parameters.items():
            if name not in self._names:
                raise unknown_name("fixed parameter", name, self._names)
            self._parameters[name] = float(value)
        columns = np.concatenate(self._ends)[self._kept]
        values = np.concatenate([columns, [float(t)], [self._parameters[name] for name in self._names]])
        if not np.isfinite(values).all():
            raise InputError("A step needs finite numbers, but its time, state or parameters hold NaN or infinity.")
        return values

    def _read(self, which: int, name: str, state: State) -> Array:
        if not isinstance(state, State):
            raise InputError(f"The {name} of a step must be an rt.State, got {type(state).__name__}.")
        given, own = state.bounds(self._phase.dae, name), self._fixed[which]
        lower, upper = given.lower[own], given.upper[own]
        if not np.array_equal(lower, upper):
            loose = self._phase.dae.states[int(own[np.flatnonzero(lower != upper)[0]])].name
            raise InputError(f"The {name} of a step leaves {loose!r} open, which the problem fixes: give its value.")
        return lower
