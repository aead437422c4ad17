"""The nonlinear program: named, scaled, open to inspection.

    minimise f(w)  subject to  lower <= g(w) <= upper,  lower <= w <= upper

Public vectors are in physical units. ``functions`` take the scaled vector w / scale and return the scaled rows
g * row_scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine, StageMapped, VirtualMachine
from robotraj.transcription.assembly.assembly import Functions, assemble, point_functions
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import scaled
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.scalar_table import Scalars

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from scipy import sparse

    from robotraj.problem.problem import Problem
    from robotraj.transcription.interval_limits.row_places import AddedRow, Margins


OBJECTIVE_SIZES = 1.0, 1e5
"""Least and greatest size of the objective of a solver, whose tolerance of 1e-8 is absolute."""
NEGLIGIBLE = 1e-12
"""Objective at the guess that counts as zero, relative to that one unit of every scaled variable away."""


@dataclass(frozen=True, eq=False)
class Nlp(OneLine):
    """A transcribed problem.

    Attributes
    ----------
    problem : Problem
    layouts : tuple of PhaseLayout
        Columns of each phase's unknowns.
    link_columns : tuple of ndarray of int
        Columns of each link's unknowns.
    variables, rows : Scalars
        Meaning, time and bounds of the columns and of the rows.
    blocks : tuple of Block
        Blocks in physical units.
    linear : sparse (n_g, n_w)
        The linear part of the rows.
    scale, row_scale : ndarray (n_w,), (n_g,)
        w = scale * w_scaled, g_scaled = row_scale * g.
    guess : ndarray (n_w,)
        Start of the solver.
    free : Scalars
        The columns without the bounds of the phases.
    engine : Engine
        Engine that evaluates the blocks' point functions.
    interval_limits : ConstraintGeneration
        Method that imposes limits between the collocation points.
    smoothing : float
        Weight of the mean square of bounded variables beside a duration (``transcription.smoothness``).
    loose_rows : Scalars or None
        The rows without margins, if ``rows`` have margins.
    keeps_clear : bool
        Whether rows on distances were added, whose planes belong to one motion.
    additions : tuple of tuple of AddedRow
        Rows that were added between the points, in the order in which they were added.
    margins : mapping
        Amounts by which limits are lowered on single intervals.
    """

    problem: Problem
    layouts: tuple[PhaseLayout, ...]
    link_columns: tuple[NDArray[np.int_], ...]
    variables: Scalars
    rows: Scalars
    blocks: tuple[Block, ...]
    linear: csr_array
    scale: Array
    row_scale: Array
    guess: Array
    free: Scalars
    engine: Engine = field(default_factory=VirtualMachine)
    interval_limits: ConstraintGeneration = field(default_factory=ConstraintGeneration)
    smoothing: float = 0.0
    loose_rows: Scalars | None = None
    keeps_clear: bool = False
    additions: tuple[tuple[AddedRow, ...], ...] = ()
    margins: Margins = field(default_factory=dict)

    @cached_property
    def functions(self) -> Functions:
        """Objective, rows and their derivatives in scaled variables."""
        blocks = [block.scaled(self.scale, self.row_scale) for block in self.blocks]
        return assemble(blocks, scaled(self.linear, self.row_scale, self.scale), self.engine)

    @property
    def compiling(self) -> float:
        """Time in which the engine prepared ``functions`` [s], 0 before they are used."""
        return self.functions.preparing if "functions" in self.__dict__ else 0.0

    @property
    def point_functions(self) -> list[StageMapped]:
        """Every stage function that ``functions`` call, with its number of places."""
        return point_functions(self.blocks)

    def outputs(self, w: Array) -> tuple[Array, ...]:
        """Return the outputs of every block at w, (n_y, E) each; the methods below accept them."""
        return tuple(block.outputs(w) for block in self.blocks)

    def objective(self, w: Array, outputs: Sequence[Array] | None = None) -> float:
        """Return the objective at w in physical units, with the cost of ``smoothing``."""
        every = self.outputs(w) if outputs is None else outputs
        return sum(block.objective(own) for block, own in zip(self.blocks, every, strict=True))

    def objective_scale(self, start: float) -> float:
        """Return the factor that scales the objective so that a solver's absolute tolerance is relative to it.

        The size is the objective at the guess. For objectives that start from zero, such as efforts of a robot at
        rest, it is the objective one unit of every scaled variable away. The factor is 1 inside ``OBJECTIVE_SIZES``.

        Parameters
        ----------
        start : float
            Objective at the guess.
        """
        least, greatest = OBJECTIVE_SIZES
        size = abs(start)
        if size < least:
            away = np.clip(self.guess + self.scale, self.variables.lower, self.variables.upper)
            with np.errstate(all="ignore"):
                other = abs(self.objective(away))
            size = size if size > NEGLIGIBLE * other else other
        return float(np.clip(size, least, greatest) / size) if np.isfinite(size) and size > 0.0 else 1.0

    def values(self, w: Array, outputs: Sequence[Array] | None = None) -> Array:
        """Return the rows g at w, in physical units, (n_g,)."""
        values = np.asarray(self.linear @ w)
        for block, own in zip(self.blocks, self.outputs(w) if outputs is None else outputs, strict=True):
            values += block.rows(own)
        return values

    def gradient(self, w: Array) -> Array:
        """Return the gradient of the objective, (n_w,)."""
        return np.array(self.functions.gradient(w / self.scale, [])[1]).ravel() / self.scale

    def jacobian(self, w: Array) -> sparse.csc_array:
        """Return the exact dg/dw, sparse (n_g, n_w)."""
        from scipy import sparse

        scaled = self.functions.jacobian(w / self.scale, [])[1].sparse()
        return sparse.csc_array(sparse.diags_array(1 / self.row_scale) @ scaled @ sparse.diags_array(1 / self.scale))

    def hessian(self, w: Array, multipliers: Array, objective_weight: float = 1.0) -> sparse.csc_array:
        """Return the exact Hessian of objective_weight f + multipliers' g, sparse symmetric (n_w, n_w)."""
        from scipy import sparse

        scaled = self.functions.hessian(w / self.scale, [], objective_weight, multipliers / self.row_scale).sparse()
        upper = sparse.csc_array(sparse.diags_array(1 / self.scale) @ scaled @ sparse.diags_array(1 / self.scale))
        return sparse.csc_array(upper + sparse.triu(upper, 1).T)

    def times(self, scalars: Scalars, w: Array) -> Array:
        """Return the time of every column or row [s]."""
        phase = np.array([entry.phase for entry in scalars.entries], dtype=int)[scalars.meaning]
        times = np.empty(len(scalars))
        for i, layout in enumerate(self.layouts):
            chosen = phase == i
            times[chosen] = np.interp(scalars.fraction[chosen], layout.mesh.knots, layout.breaks(w))
        return times

    def names(self, scalars: Scalars) -> list[str]:
        """Return the names of columns or rows: phase, meaning, joint and time at the guess."""
        times = self.times(scalars, self.guess)
        phases = self.problem.phases
        labels = [f"{phases[e.phase].name}: {e}" for e in scalars.entries]
        return [f"{labels[m]}, t = {t:.4g} s" for m, t in zip(scalars.meaning, times, strict=True)]

    @property
    def variable_names(self) -> list[str]:
        """One name per column."""
        return self.names(self.variables)

    @property
    def row_names(self) -> list[str]:
        """One name per row."""
        return self.names(self.rows)

    def spy(self) -> Figure:
        """Plot the sparsity of the Jacobian and of the Lagrangian's Hessian."""
        from robotraj.transcription.spy import spy

        return spy(self.functions, self.rows, len(self.variables))

    def __str__(self) -> str:
        jacobian = self.functions.jacobian.nnz_out(1)
        hessian = self.functions.hessian.nnz_out(0)
        return (
            f"NLP of {len(self.problem.phases)} phase(s): {len(self.variables)} variables, {len(self.rows)} rows, "
            f"{jacobian} nonzeros in the Jacobian, {hessian} in the Hessian's upper triangle"
        )
