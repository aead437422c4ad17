"""Free durations: the same motion, stretched to a fixed duration T_0.

With s = T / T_0, velocities of the stretched motion are v' = s v and accelerations a' = s^2 a. Where an objective
depends on them, rates of torques are r' = s r and jerks j' = s^3 j. In these variables dq/dt = v, dv/dt = a, da/dt = j
and dtau/dt = r are linear in all unknowns, although the duration is one of them. The duration remains in the torque
balance RNEA(q, v' / s, a' / s^2) and in the speed limits v' <= s v_max, which are linear too. A defect of velocities is
multiplied by s, and one of accelerations by s^2, which does not change their zeros.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.sparse import csr_array, vstack
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import TimeOrders
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.problem.augmentation import Augmented
from robotraj.solvers.stagewise.form import Form, with_empty_rows, with_rows
from robotraj.solvers.stagewise.matrices import entries, entries_of, summed
from robotraj.solvers.stagewise.stage_cache import StageCache
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.mesh import MovingMesh

_STRETCHED: StageCache[PointFunctions] = StageCache()


@dataclass(frozen=True, eq=False)
class Stretch:
    """The columns that are stretched, and their durations.

    Attributes
    ----------
    power : ndarray of int (n_w,)
        k of w = w' / s^k: 1 for velocities, 2 for accelerations, 0 for positions; see ``TimeOrders``.
    clock : ndarray of int (n_w,)
        The duration's column, -1 where the power is 0.
    unit : ndarray (n_w,)
        1 / T_0 in scaled units: s = w[clock] * unit.
    rows : ndarray of int (n_rows,)
        k where a row of the NLP was multiplied by s^k.
    row_clock : ndarray of int (n_rows,)
        The duration's column of such a row, else -1.
    """

    power: Indices
    clock: Indices
    unit: Array
    rows: Indices
    row_clock: Indices

    def columns(self, stretched: Array) -> Array:
        """Return w for w'."""
        s = self.factor(stretched, self.clock)
        return np.asarray(stretched / s**self.power)

    def stretched(self, w: Array) -> Array:
        """Return w' for w."""
        return np.asarray(w * self.factor(w, self.clock) ** self.power)

    def factor(self, w: Array, clock: Indices) -> Array:
        """Return s for durations in columns ``clock``, 1 where the column is -1."""
        return np.where(clock >= 0, w[clock] * self.unit[clock], 1.0)


def stretch(form: Form, nlp: Nlp, before: Stretch | None = None) -> tuple[Form, Stretch | None]:
    """Rewrite the phases of free duration whose rates are plain velocities and accelerations.

    Parameters
    ----------
    form : Form
        As returned by ``Form.of(nlp)``.
    nlp : Nlp
    before : Stretch, optional
        Stretch of a similar NLP. Its T_0 are used again if they are within a factor of 2 of the guess, so that
        coefficients stay the same.

    Returns
    -------
    form : Form
    known : Stretch or None
        None where no phase is rewritten.
    """
    n_w, n_rows = len(form.lower), len(form.row_lower)
    power, clock, unit = np.zeros(n_w, dtype=int), np.full(n_w, -1), np.ones(n_w)
    every = ((i, _orders(nlp, i)) for i in range(len(nlp.layouts)))
    phases = {i: orders for i, orders in every if orders is not None}
    for i, orders in phases.items():
        layout = nlp.layouts[i]
        column = layout.duration.column
        assert column is not None
        parts = [(layout.knots, orders.states)]
        for run in layout.runs:
            kinds = (run.states, orders.states), (run.algebraic, orders.algebraic), (run.controls, orders.controls)
            parts += [(columns, own) for columns, own in kinds if columns.size]
        for columns, own in parts:
            flat, k = columns.reshape(-1, len(own)), np.array(own)
            power[flat] = k
            clock[flat[:, k > 0]] = column
        # States of rows that were added between the points are in no layout. ``meaning`` identifies their variables.
        meaning = nlp.variables.meaning
        for number, order in zip(meaning[layout.knots[0]].tolist(), orders.states, strict=True):
            if order > 0:
                same = np.flatnonzero(meaning == number)
                power[same], clock[same] = order, column
        unit[column] = nlp.scale[column] / max(nlp.guess[column], 1e-3)
        if before is not None and 0.5 <= before.unit[column] / unit[column] <= 2:
            unit[column] = before.unit[column]
    rows, row_clock = np.zeros(n_rows, dtype=int), np.full(n_rows, -1)
    for index, of_points in phases.items():
        block, powers = form.blocks[index], np.array(of_points.states)
        for k in sorted(set(powers[powers > 0].tolist())):
            outputs = (np.arange(block.count)[:, None] * block.stage.outputs + np.flatnonzero(powers == k)).ravel()
            touched = np.flatnonzero(np.bincount(block.scatter.tocsc()[:, outputs].indices))
            rows[touched], row_clock[touched] = k, nlp.layouts[index].duration.column
    if not phases or _limits_accelerations(form, power, rows):
        return form, None
    blocks = [_block(block, power, clock, unit, nlp, phases.get(i)) for i, block in enumerate(form.blocks)]
    known = Stretch(power, clock, unit, rows, row_clock)
    form = replace(form, blocks=tuple(blocks))
    return _limits(_limits(form, known, of_rows=True), known, of_rows=False), known


def _limits_accelerations(form: Form, power: Indices, rows: Indices) -> bool:
    """Whether bounds or linear rows depend on accelerations w' / s^2, in which they are not linear.

    Defects of accelerations are linear, since they are multiplied by s^2.
    """
    columns, held = power >= 2, rows >= 2
    bounds = form.lower[columns], form.upper[columns]
    limits = form.row_lower[held], form.row_upper[held]
    bounded = any(np.isfinite(each).any() for each in bounds) or any(np.any(each != 0.0) for each in limits)
    row, read, _ = entries(form.linear)
    return bool(bounded or np.any(columns[read] & (power[read] != rows[row])))


def _orders(nlp: Nlp, index: int) -> TimeOrders | None:
    """Return the orders of a phase's variables; None where its duration is fixed or its motion cannot be stretched."""
    layout, dae = nlp.layouts[index], nlp.problem.phases[index].dae
    if layout.duration.column is None or isinstance(layout.mesh, MovingMesh):
        return None
    return dae.time_orders if isinstance(dae, RigidBody | Augmented) else None


def _block(block: Block, power: Indices, clock: Indices, unit: Array, nlp: Nlp, orders: TimeOrders | None) -> Block:
    """Substitute w' / s^k in a block; ``orders`` are those of the variables of a phase's points, None elsewhere."""
    stage, count = block.stage, block.count
    first = block.gather.indptr[:-1].reshape(count, -1)
    filled = np.diff(block.gather.indptr).reshape(count, -1) > 0
    column = np.zeros(first.shape, dtype=int)
    column[filled] = block.gather.indices[first[filled]]
    powers = np.where(filled, power[column], 0)
    inputs = np.flatnonzero(powers.any(axis=0))
    if not inputs.size:
        return block
    # All places of a block belong to one phase, so that each input has one clock. A link has clocks of several phases.
    own = np.where(powers > 0, clock[column], -1).max(axis=0)[inputs]
    clocks, which = np.unique(own, return_inverse=True)
    degrees = tuple((int(i), int(powers[:, i].max()), int(s)) for i, s in zip(inputs, which, strict=True))
    rates = None
    if orders is not None:
        variables = sum(map(len, orders))
        rates = _rates(stage, len(orders.states), variables), float(nlp.scale[clocks[0]] / unit[clocks[0]])
    changed = _STRETCHED.get(stage, (degrees, rates), partial(_stage, stage, degrees, rates))
    gather = block.gather
    width, added = stage.inputs, clocks.size
    place = gather.row // width
    moved = place * (width + added) + gather.row % width
    more = (np.arange(count)[:, None] * (width + added) + width + np.arange(added)).ravel()
    every = np.tile(clocks, count)
    gather = csr_array(
        (
            np.append(gather.data, unit[every]),
            (np.append(moved, more), np.append(gather.col, every)),
        ),
        shape=(count * (width + added), gather.shape[1]),
    )
    return replace(block, stage=changed, gather=gather)


def _rates(stage: PointFunctions, states: int, variables: int) -> tuple[int, ...]:
    """Find the input, among the first ``variables``, that is the rate of each state; T times it is the output."""
    output, read = stage.jacobian_pattern
    mine = (output < states) & (read < variables)
    rates = np.full(states, -1)
    np.maximum.at(rates, output[mine], read[mine])
    return tuple(rates.tolist())


def _stage(
    stage: PointFunctions, degrees: Sequence[tuple[int, int, int]], rates: tuple[tuple[int, ...], float] | None
) -> PointFunctions:
    """Return the point functions of w' and every s, with w = w' / s^k.

    Parameters
    ----------
    stage : PointFunctions
    degrees : sequence of (input, k, number of its s)
    rates : (inputs, T_0) or None
        The inputs whose products with T are the first outputs. These become T_0 v' and, multiplied by s, T_0 a'.
    """
    inputs, powers, which = zip(*degrees, strict=True)
    s, v = ca.SX.sym("s", 1 + max(which)), stage.v
    old = v[list(inputs)]
    new = old / ca.vertcat(*(s[i] ** k for i, k in zip(which, powers, strict=True)))
    y = ca.substitute(stage.y, old, new)
    if rates is not None:
        read, span = rates
        y = ca.vertcat(span * v[list(read)], y[len(read) :])
    torques = stage.torques and stage.torques.substituted(old, new)
    return PointFunctions(ca.vertcat(v, s), stage.c, y, stage.costed, torques, as_tapes=stage.as_tapes)


def _limits(form: Form, known: Stretch, of_rows: bool) -> Form:
    """Replace bounds l <= x' / s <= u of rows or velocities by rows x' - l s >= 0 and x' - u s <= 0."""
    if of_rows:
        lower, upper, clock = form.row_lower.copy(), form.row_upper.copy(), known.row_clock
    else:
        lower, upper, clock = form.lower.copy(), form.upper.copy(), np.where(known.power == 1, known.clock, -1)
    same = lower == upper
    below = np.flatnonzero((clock >= 0) & np.isfinite(lower) & (lower != 0.0))
    above = np.flatnonzero((clock >= 0) & np.isfinite(upper) & (upper != 0.0) & ~same)
    chosen, many = np.append(below, above), below.size + above.size
    if not many:
        return form
    bound = np.append(lower[below], upper[above])
    new_lower = np.append(np.zeros(below.size), np.full(above.size, -np.inf))
    new_upper = np.append(np.where(same[below], 0.0, np.inf), np.zeros(above.size))
    lower[below], upper[above] = -np.inf, np.inf
    upper[below[same[below]]] = np.inf
    row, column, n_w = np.arange(many), clock[chosen], form.linear.columns
    minus = row, column, -bound * known.unit[column]
    if of_rows:
        own = entries_of(form.linear, chosen)
        blocks = [replace(b, scatter=vstack([b.scatter, b.scatter[chosen]])) for b in form.blocks]
        form = replace(form, row_lower=lower, row_upper=upper)
    else:
        own = row, chosen, np.ones(many)
        blocks = [with_empty_rows(block, many) for block in form.blocks]
        form = replace(form, lower=lower, upper=upper)
    form = replace(form, blocks=tuple(blocks))
    behind = {"limit_of": chosen} if of_rows else {"bound_of": chosen}
    return with_rows(form, summed((many, n_w), own, minus).pruned(), new_lower, new_upper, **behind)
