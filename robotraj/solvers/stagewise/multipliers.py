"""Multipliers of the NLP from those of its program.

Multipliers of the program's rows and bounds are copied. Eliminated rows are defects that define a state and balances
that define a control. Their multipliers follow from stationarity in the columns eliminated with them,

    (grad f + J' lambda + z)_c = 0,

with as many equations as unknowns. Multipliers of the bounds of fixed columns follow from the same, column by column.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj.solvers.stagewise.reduction import Reduction


def recover(reduction: Reduction, y: Array, multipliers: Array) -> tuple[Array, Array]:
    """Return the multipliers of the NLP's rows (n_g,) and bounds (n_w,), in physical units.

    Parameters
    ----------
    reduction : Reduction
    y : ndarray (n_y,)
        Solution of the program.
    multipliers : ndarray (n_rows,)
        Multipliers of the program's rows: grad(objective) + J' multipliers = 0.
    """
    from scipy import sparse
    from scipy.sparse.linalg import spsolve

    nlp, form, program = reduction.nlp, reduction.form, reduction.program
    every = np.zeros(len(form.row_lower))
    path = program.form_rows >= 0
    every[program.form_rows[path]] = multipliers[path]
    bounds = np.zeros(len(form.lower))
    mine = program.bound_columns >= 0
    np.add.at(bounds, program.bound_columns[mine], multipliers[mine])

    w = reduction.columns(y)
    rows = np.zeros(len(nlp.rows))
    of_bound = np.flatnonzero(form.bound_of >= 0)
    of_row = np.flatnonzero(form.limit_of >= 0)
    factor = np.ones(len(form.row_lower))
    if reduction.stretched is not None:
        # A stretched row is s^k times the row of the NLP.
        stretched = reduction.stretched
        scaled = w / nlp.scale
        columns = form.bound_of[of_bound]
        factor[of_bound] = stretched.factor(scaled, np.where(stretched.power == 1, stretched.clock, -1)[columns])
        # A bound of zero remains a bound, on s^k times the column of the NLP.
        bounds *= stretched.factor(scaled, stretched.clock) ** stretched.power
        limited = form.limit_of[of_row]
        factor[of_row] = stretched.factor(scaled, stretched.row_clock[limited]) ** stretched.rows[limited]
    np.add.at(bounds, form.bound_of[of_bound], (factor * every)[of_bound])
    np.add.at(rows, form.limit_of[of_row], (factor * every)[of_row])

    jacobian = sparse.csr_array(sparse.diags_array(nlp.row_scale) @ nlp.jacobian(w) @ sparse.diags_array(nlp.scale))
    used, given = [reduction.slots.used], [form.targets[reduction.slots.used]]
    for gone in form.eliminated:
        used.append(gone.rows.ravel())
        given.append(gone.columns.ravel())
    lost, columns = np.concatenate(used), np.concatenate(given)
    rows[lost] = 0.0
    rest = nlp.gradient(w) * nlp.scale + jacobian.T @ rows + bounds
    if lost.size:
        square = sparse.csc_array(jacobian[lost][:, columns].T)
        rows[lost] = spsolve(square, -rest[columns])
    known = reduction.known
    bounds[known] = -(nlp.gradient(w) * nlp.scale + jacobian.T @ rows)[known]
    return rows * nlp.row_scale, bounds / nlp.scale
