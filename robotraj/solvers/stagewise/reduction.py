"""From an NLP to a program in stages and back.

The reduction eliminates fixed columns, controls defined by a torque balance and states defined by a linear defect.
Columns are recovered from their expressions, and multipliers from stationarity.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array, Mask
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.controls import eliminate_controls
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.free_durations import Stretch, stretch
from robotraj.solvers.stagewise.linear import extract_linear
from robotraj.solvers.stagewise.order import Order, allowed_stages, order
from robotraj.solvers.stagewise.program import StageProgram, build
from robotraj.solvers.stagewise.program import with_values as program_with_values
from robotraj.solvers.stagewise.redundant_rows import remove_repeated_rows, remove_satisfied_rows
from robotraj.solvers.stagewise.slots import Slots, make_slots
from robotraj.solvers.stagewise.slots import with_values as slots_with_values
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.onestep import OneStep


class NotStagewise(Exception):
    """The problem has no form in stages; the message has the reason."""


@dataclass(frozen=True, eq=False)
class Reduction:
    """An NLP, its program, and the maps between them.

    Attributes
    ----------
    nlp : Nlp
    form, order, slots : Form, Order, Slots
    program : StageProgram
    known : ndarray of bool (n_w,)
        Whether a column is replaced by a number.
    values : ndarray (n_w,)
        Scaled values of these columns.
    stretched : Stretch or None
        Map between velocities and accelerations of ``form`` and those of the NLP.
    """

    nlp: Nlp
    form: Form
    order: Order
    slots: Slots
    program: StageProgram
    known: Mask
    values: Array
    stretched: Stretch | None

    def unknowns(self, w: Array) -> Array:
        """Return y for a decision vector w in physical units."""
        return self.start(w)

    def start(self, w: Array) -> Array:
        """Return the start of a solve from w, which is y."""
        scaled = w / self.nlp.scale
        if self.stretched is not None:
            scaled = self.stretched.stretched(scaled)
        return scaled[self.slots.variables]

    def columns(self, y: Array) -> Array:
        """Return the decision vector w in physical units for y."""
        slots = self.slots
        w = self.nlp.guess / self.nlp.scale
        w[self.known] = self.values[self.known]
        alive = np.flatnonzero(slots.last >= slots.first)
        at = slots.at(alive, slots.last[alive])
        w[alive] = (slots.matrix @ y + slots.offset)[at]
        for gone in self.form.eliminated:
            block = self.form.blocks[gone.block]
            outputs = block.outputs(w)
            w[gone.columns] = gone.factors * outputs[gone.outputs].T
        if self.stretched is not None:
            w = self.stretched.columns(w)
        return np.asarray(w * self.nlp.scale)

    def refreshed(self, nlp: Nlp) -> Reduction | None:
        """Reduce another NLP of the same structure with the patterns and combinations of this one.

        Parameters
        ----------
        nlp : Nlp
            An NLP of the same point functions with other bounds, fixed values, guess or constants.

        Returns
        -------
        Reduction or None
            None where it differs in more: in the bounds that are finite, the columns that are fixed, the mesh, the
            scales, or a bound that is a coefficient (speed limits at a free duration).
        """
        parts = "blocks", "linear", "rows", "variables", "scale", "row_scale"
        if all(getattr(nlp, part) is getattr(self.nlp, part) for part in parts):
            return replace(self, nlp=nlp)  # the guess alone differs
        form, stretched, order_, known = _staged(nlp, self.stretched)
        if not (self.form.alike(form) and self.order.alike(order_) and np.array_equal(self.known, known)):
            return None
        values = np.where(known, form.lower, 0.0)
        slots = slots_with_values(self.slots, form, order_, known, values)
        program = program_with_values(self.program, form, order_, slots, known, values)
        if program is None:
            return None
        return Reduction(nlp, form, order_, slots, program, known, values, stretched)


def reduce(nlp: Nlp) -> Reduction:
    """Write an NLP in stages.

    Raises
    ------
    NotStagewise
        A phase is planned by shooting. Rows that couple distant intervals, such as an integral constraint, are allowed
        and lead to wide stages.
    """
    form, stretched, order_, known = _staged(nlp)
    values = np.where(known, form.lower, 0.0)
    slots = make_slots(form, order_, known, values)
    return Reduction(nlp, form, order_, slots, build(form, order_, slots, known, values), known, values, stretched)


def _staged(nlp: Nlp, before: Stretch | None = None) -> tuple[Form, Stretch | None, Order, Mask]:
    """Return the form, its stages, and a mask of columns that are numbers."""
    for layout, phase in zip(nlp.layouts, nlp.problem.phases, strict=True):
        if isinstance(layout.scheme, OneStep):
            raise NotStagewise(f"phase {phase.name!r} is planned by {type(layout.scheme).__name__}")
    form, stretched = stretch(remove_satisfied_rows(Form.of(nlp), nlp), nlp, before)
    form = remove_repeated_rows(eliminate_controls(extract_linear(form), nlp), nlp)
    ends = [min(link.phases) for link in nlp.problem.bound_links]
    low, high, stages = allowed_stages(nlp.layouts, nlp.link_columns, ends, len(nlp.variables))
    known = (form.lower == form.upper) & ~form.gone
    known &= ~_defined(form)
    return form, stretched, order(form, low, high, stages, known), known


def _defined(form: Form) -> Mask:
    """Return a mask of columns that a linear row may define; fixed ones among them are rows, not numbers."""
    mask = np.zeros(len(form.lower), dtype=bool)
    mask[form.targets[form.targets >= 0]] = True
    return mask
