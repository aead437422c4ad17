"""Programs whose fixed columns change from solve to solve, as the measured start of a control loop does.

Offsets of the rows, of the blocks and of the columns that a reduction eliminated are affine in the fixed columns e,

    offsets(e) = offsets(e0) + M (e - e0).

M is found once, by refreshing the formulation with each fixed column moved by its scale. A later change costs one
sparse product; nothing symbolic is evaluated.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.reduction import Reduction

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from robotraj.solvers.formulation import Formulation
    from robotraj.transcription.nlp import Nlp

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

NEGLIGIBLE = 1e-12
"""Entries of M below this share of the offsets are rounding."""
AGREEMENT = 1e-9
"""Largest error of the affine offsets at an independent change, relative to the offsets."""


@dataclass(frozen=True, eq=False)
class MovingEnds:
    """A formulation as a function of its fixed columns.

    Attributes
    ----------
    formulation : Formulation
        At the values ``base``.
    columns : ndarray of int (m,)
        The fixed columns of the NLP that change.
    base : ndarray (m,)
        Their values, in physical units.
    offsets : ndarray (k,)
        At ``base``.
    matrix : csr_array (k, m)
        M.
    """

    formulation: Formulation
    columns: Indices
    base: Array
    offsets: Array
    matrix: csr_array

    def at(self, values: Array) -> Formulation:
        """Return the formulation for other values of the columns (m,), in physical units."""
        offsets = self.offsets + self.matrix @ (values - self.base)
        return _with_offsets(self.formulation, offsets, self.columns, values)


def moving_ends(formulation: Formulation, columns: Indices) -> MovingEnds:
    """Find how the offsets of a formulation depend on fixed columns.

    Raises
    ------
    InputError
        A column is not fixed, or a change of the columns changes more than offsets.
    """
    from scipy.sparse import csr_array

    nlp = formulation.nlp
    base = nlp.variables.lower[columns]
    if not np.array_equal(base, nlp.variables.upper[columns]):
        raise InputError("Only fixed ends can move: a column of the ends has a range.")
    offsets = _offsets(formulation)
    parts = []
    for j, step in enumerate(nlp.scale[columns]):
        moved = base.copy()
        moved[j] += step
        parts.append((_offsets(_refreshed(formulation, columns, moved)) - offsets) / step)
    matrix = np.stack(parts, axis=1)
    matrix[np.abs(matrix) < NEGLIGIBLE * np.max(np.abs(matrix), initial=0.0)] = 0.0
    found = MovingEnds(formulation, columns, base, offsets, csr_array(matrix))
    other = base + nlp.scale[columns] * np.cos(np.arange(columns.size))
    expected = _offsets(_refreshed(formulation, columns, other))
    error = np.max(np.abs(_offsets(found.at(other)) - expected), initial=0.0)
    if error > AGREEMENT * max(1.0, float(np.max(np.abs(expected), initial=0.0))):
        raise InputError("The offsets of this problem are not affine in its ends: plan each start with rt.plan.")
    return found


def _refreshed(formulation: Formulation, columns: Indices, values: Array) -> Formulation:
    found = formulation.refreshed(fixed_at(formulation.nlp, columns, values))
    same_bounds = found is not None and all(
        np.array_equal(getattr(found.program, side), getattr(formulation.program, side)) for side in ("lower", "upper")
    )
    if found is None or not same_bounds:
        raise InputError("Other ends change the structure of this problem: plan each start with rt.plan.")
    return found


def fixed_at(nlp: Nlp, columns: Indices, values: Array) -> Nlp:
    """Return an NLP with other values of its fixed columns."""
    lower, upper, guess = nlp.variables.lower.copy(), nlp.variables.upper.copy(), nlp.guess.copy()
    lower[columns] = upper[columns] = guess[columns] = values
    return replace(nlp, variables=replace(nlp.variables, lower=lower, upper=upper), guess=guess)


def _offsets(formulation: Formulation) -> Array:
    """Join the numbers that depend on fixed columns."""
    program = formulation.program
    constant = np.array([program.constant])
    parts = [constant, program.shift, formulation.values, *(block.shift for block in program.blocks)]
    if isinstance(formulation, Reduction):
        parts.append(formulation.slots.offset)
    return np.concatenate(parts)


def _with_offsets(formulation: Formulation, offsets: Array, columns: Indices, values: Array) -> Formulation:
    """Take the numbers apart again."""
    program, nlp = formulation.program, formulation.nlp
    sizes = [1, program.shift.size, formulation.values.size, *(block.shift.size for block in program.blocks)]
    constant, shift, known, *rest = np.split(offsets, np.cumsum(sizes))
    blocks = tuple(replace(block, shift=own) for block, own in zip(program.blocks, rest, strict=False))
    program = replace(program, constant=float(constant[0]), shift=shift, blocks=blocks)
    changed = fixed_at(nlp, columns, values)
    if isinstance(formulation, Reduction):
        return replace(
            formulation, nlp=changed, program=program, values=known, slots=replace(formulation.slots, offset=rest[-1])
        )
    return replace(formulation, nlp=changed, program=program, values=known)
