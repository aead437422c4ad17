"""Programs as functions of the numbers fixed in them: ends, start time and parameters of a phase.

A control loop solves one problem with other numbers e at every step. The offsets of rows, of blocks and of eliminated
columns, and the bounds of rows, are affine in e:

    offsets(e) = offsets(e0) + M (e - e0).

Constants of the point functions are entries of e. M is found once, by refreshing the formulation with each number
changed. A later change takes one sparse product, without symbolic work.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import DIFFERENCE, ROUND_OFF, SAME
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.reduction import Reduction
from robotraj.transcription.collocation.symbols import phase_scalars
from robotraj.transcription.layout import Scalar

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from robotraj.solvers.formulation import Formulation
    from robotraj.transcription.assembly.block import Block
    from robotraj.transcription.assembly.point_functions import PointFunctions
    from robotraj.transcription.nlp import Nlp


@dataclass(frozen=True, eq=False)
class Numbers:
    """The numbers of an NLP of one phase that change from solve to solve.

    Attributes
    ----------
    columns : ndarray of int (m,)
        Fixed columns of the NLP.
    scalars : tuple of int
        Places of fixed scalars among start time, duration and parameters of the phase.
    places : tuple of int
        Their places among the constants of a point function, from the last.
    readers : frozenset of PointFunctions
        The point functions whose constants they are.
    """

    columns: Indices
    scalars: tuple[int, ...]
    places: tuple[int, ...]
    readers: frozenset[PointFunctions]

    def values(self, nlp: Nlp) -> Array:
        """Return the numbers of an NLP (m + scalars,), in physical units.

        Raises
        ------
        InputError
            A column is not fixed.
        """
        lower = nlp.variables.lower[self.columns]
        if not np.array_equal(lower, nlp.variables.upper[self.columns]):
            raise InputError("A Replanner changes only fixed values, but a value at an end has a range; fix it.")
        every = phase_scalars(nlp.layouts[0])
        return np.append(lower, [every[i].value for i in self.scalars])

    def steps(self, nlp: Nlp) -> Array:
        """Return the changes of the numbers (m + scalars,) that find M; larger ones may exceed bounds."""
        return DIFFERENCE * np.append(nlp.scale[self.columns], np.ones(len(self.scalars)))

    def changed(self, nlp: Nlp, values: Array) -> Nlp:
        """Return an NLP with other numbers."""
        columns, layout = self.columns, nlp.layouts[0]
        lower, upper, guess = nlp.variables.lower.copy(), nlp.variables.upper.copy(), nlp.guess.copy()
        lower[columns] = upper[columns] = guess[columns] = values[: columns.size]
        variables = replace(nlp.variables, lower=lower, upper=upper)
        if not self.scalars:
            return replace(nlp, variables=variables, guess=guess)
        every = phase_scalars(layout)
        for place, value in zip(self.scalars, values[columns.size :], strict=True):
            every[place] = Scalar(None, float(value))
        layout = replace(layout, t0=every[0], duration=every[1], parameters=tuple(every[2:]))
        blocks = tuple(self.with_constants(block, values) for block in nlp.blocks)
        return replace(nlp, variables=variables, guess=guess, layouts=(layout,), blocks=blocks)

    def with_constants(self, block: Block, values: Array) -> Block:
        """Return a block with other fixed scalars; one that does not read them is returned unchanged."""
        if block.stage not in self.readers:
            return block
        constants = block.constants.copy()
        constants[list(self.places)] = values[self.columns.size :, None]
        return replace(block, constants=constants)


def numbers_of(formulation: Formulation, columns: Indices, scalars: Sequence[int]) -> Numbers:
    """Return the numbers of an NLP: its fixed columns and scalars, and the functions that read the scalars.

    Fixed scalars are the last constants of a point function. One with other constants, such as those of supporting
    planes, does not read them.
    """
    nlp, form = formulation.nlp, formulation.form.blocks if isinstance(formulation, Reduction) else ()
    blocks = [*nlp.blocks, *(part.block for part in formulation.program.blocks), *form]
    known = [(i, scalar.value) for i, scalar in enumerate(phase_scalars(nlp.layouts[0])) if scalar.column is None]
    fixed, order = np.array([value for _, value in known]), [i for i, _ in known]
    readers = {
        block.stage
        for block in blocks
        if scalars and len(block.constants) >= len(known) and np.all(block.constants[-len(known) :] == fixed[:, None])
    }
    return Numbers(columns, tuple(scalars), tuple(order.index(i) - len(order) for i in scalars), frozenset(readers))


@dataclass(frozen=True, eq=False)
class Parametric:
    """A formulation as a function of numbers.

    Attributes
    ----------
    formulation : Formulation
        Formulation at the numbers ``base``.
    numbers : Numbers
    base : ndarray (e,)
        e0.
    offsets : ndarray (k,)
        Offsets at ``base``.
    matrix : csr_array (k, e)
        M.
    """

    formulation: Formulation
    numbers: Numbers
    base: Array
    offsets: Array
    matrix: csr_array

    def at(self, values: Array) -> Formulation:
        """Return the formulation for other numbers (e,), in physical units."""
        known, numbers = self.formulation, self.numbers
        nlp, program = known.nlp, known.program
        offsets = self.offsets + self.matrix @ (values - self.base)
        constant, lower, upper, shift, eliminated, *rest = np.split(offsets, self._ends)
        blocks = tuple(
            replace(part, shift=own, block=numbers.with_constants(part.block, values)) if changes else part
            for part, own, changes in zip(program.blocks, rest, self._changing, strict=False)
        )
        program = replace(
            program,
            constant=float(constant[0]),
            shift=shift,
            blocks=blocks,
            lower=np.where(np.isfinite(program.lower), lower, program.lower),
            upper=np.where(np.isfinite(program.upper), upper, program.upper),
        )
        changed = numbers.changed(nlp, values)
        if not isinstance(known, Reduction):
            return replace(known, nlp=changed, program=program, values=eliminated)
        form = replace(known.form, blocks=tuple(numbers.with_constants(each, values) for each in known.form.blocks))
        slots = replace(known.slots, offset=rest[-1])
        return replace(known, nlp=changed, program=program, values=eliminated, form=form, slots=slots)

    @cached_property
    def _ends(self) -> Indices:
        """Ends of the parts of the offsets (``_offsets``), all but the last."""
        program, known = self.formulation.program, self.formulation
        count = program.lower.size
        own = [block.shift.size for block in program.blocks]
        return np.cumsum([1, count, count, program.shift.size, known.values.size, *own])

    @cached_property
    def _changing(self) -> list[bool]:
        """Whether the shift or the constants of each block of the program depend on the numbers."""
        depends, blocks = np.diff(self.matrix.indptr) > 0, self.formulation.program.blocks
        own = np.split(depends, self._ends)[5 : 5 + len(blocks)]
        return [
            bool(np.any(part)) or block.block.stage in self.numbers.readers
            for part, block in zip(own, blocks, strict=True)
        ]


def parametric(formulation: Formulation, columns: Indices, scalars: Sequence[int] = ()) -> Parametric:
    """Find how a formulation depends on fixed numbers.

    Parameters
    ----------
    formulation : Formulation
        Formulation of an NLP of one phase.
    columns : ndarray of int (m,)
        Fixed columns of the NLP.
    scalars : sequence of int
        Places of fixed scalars among start time, duration and parameters. The duration does not change.

    Raises
    ------
    InputError
        A column is not fixed, or a change of the numbers changes more than offsets and constants.
    """
    from scipy.sparse import csr_array

    numbers = numbers_of(formulation, columns, scalars)
    base, steps, offsets = numbers.values(formulation.nlp), numbers.steps(formulation.nlp), _offsets(formulation)
    parts = []
    for j, step in enumerate(steps):
        moved = base.copy()
        moved[j] += step
        parts.append((_offsets(_refreshed(formulation, numbers, moved)) - offsets) / step)
    matrix = np.stack(parts, axis=1)
    matrix[np.abs(matrix) < ROUND_OFF * np.max(np.abs(matrix), initial=0.0)] = 0.0
    found = Parametric(formulation, numbers, base, offsets, csr_array(matrix))
    other = base + steps * np.cos(np.arange(base.size))
    expected = _offsets(_refreshed(formulation, numbers, other))
    error = np.max(np.abs(_offsets(found.at(other)) - expected), initial=0.0)
    if error > SAME * max(1.0, float(np.max(np.abs(expected), initial=0.0))):
        raise InputError("This problem is not affine in its ends, time and parameters: plan each start with rt.plan.")
    return found


def with_constants(formulation: Formulation, given: Mapping[PointFunctions, Array]) -> Formulation:
    """Return a formulation with other constants (n_c, E) of the blocks of the given point functions."""

    def changed(block: Block) -> Block:
        constants = given.get(block.stage)
        return block if constants is None else replace(block, constants=constants)

    nlp, program = formulation.nlp, formulation.program
    nlp = replace(nlp, blocks=tuple(map(changed, nlp.blocks)))
    blocks = tuple(replace(part, block=changed(part.block)) for part in program.blocks)
    return replace(formulation, nlp=nlp, program=replace(program, blocks=blocks))


def _refreshed(formulation: Formulation, numbers: Numbers, values: Array) -> Formulation:
    found = formulation.refreshed(numbers.changed(formulation.nlp, values))
    if found is None:
        raise InputError("Other ends or parameters change the structure of this problem: plan each start with rt.plan.")
    return found


def _offsets(formulation: Formulation) -> Array:
    """Join the offsets that depend on the numbers."""
    program = formulation.program
    parts = [np.array([program.constant])]
    parts += [np.where(np.isfinite(side), side, 0.0) for side in (program.lower, program.upper)]
    parts += [program.shift, formulation.values, *(block.shift for block in program.blocks)]
    if isinstance(formulation, Reduction):
        parts.append(formulation.slots.offset)
    return np.concatenate(parts)
