"""Plot of the sparsity of an NLP."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from scipy import sparse

from robotraj.transcription.assembly.assembly import Functions
from robotraj.transcription.scalar_table import Scalars


def spy(functions: Functions, named_rows: Scalars, width: int) -> Figure:
    """Draw the nonzeros of the Jacobian and of the Lagrangian's Hessian, rows coloured by meaning."""
    figure = Figure(figsize=(12, 6), layout="constrained")
    left, right = figure.subplots(1, 2)
    rows, columns = (np.array(part) for part in functions.jacobian.sparsity_out(1).get_triplet())
    names = [entry.name for entry in named_rows.entries]
    kinds = list(dict.fromkeys(names))
    kind = np.array([kinds.index(name) for name in names], dtype=int)[named_rows.meaning]
    for number, name in enumerate(kinds):
        chosen = kind[rows] == number
        left.plot(columns[chosen], rows[chosen], ".", markersize=1.5, label=name)
    left.set(title=f"Jacobian, {rows.size} nonzeros", xlabel="variable", ylabel="row")
    left.set_xlim(-1, width)
    left.set_ylim(len(named_rows), -1)
    left.legend(markerscale=6, loc="upper right", fontsize="small")
    rows, columns = (np.array(part) for part in functions.hessian.sparsity_out(0).get_triplet())
    both = sparse.coo_array((np.ones(rows.size), (rows, columns)), shape=(width,) * 2)
    right.spy(both + sparse.triu(both, 1).T, markersize=1, color="C0")
    right.set(
        title=f"Hessian of the Lagrangian, {rows.size} in the upper triangle", xlabel="variable", ylabel="variable"
    )
    right.xaxis.set_ticks_position("bottom")
    return figure
