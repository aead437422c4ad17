"""Covector mapping: from the multipliers of the NLP to costates of the optimal control problem.

An interval of relative length d has rows x_j - x_0 - d sum_k A_jk (T f_k) = 0 with multipliers mu_j. If its
end is no node, it has a last row with the weights b and the multiplier mu_e. The factors of f_k in the
Lagrangian, divided by the quadrature weight, are the costate of stage k,

    Lambda_k = -(sum_j mu_j A_jk + mu_e b_k) / b_k,

for which d b_k T (l_k + Lambda_k' f_k) is the weighted Hamiltonian: stationarity of the NLP in u_k is that of
the Hamiltonian. The adjoint scheme of a Butcher tableau (A, b) has the coefficients b_k - b_k A_kj / b_j
(Lobatto IIIB for Lobatto IIIA, Radau IA for Radau IIA, Gauss for Gauss). So the costate has the scheme's full order at
the knots,

    lambda(t_k+) = dL_right / dx_k,    lambda(t) = lambda(t_k+) - int H_x,

with L_right the terms of the Lagrangian that belong to the interval on the right. Multipliers of algebraic
rows, path rows and bounds divided by the same weights become densities. One that is much larger than its
neighbours is an impulse instead, at which the costate jumps, as at the entry of a state-constrained arc.

Sources: Hager, Runge-Kutta methods in optimal control and the transformed adjoint system, Numerische
Mathematik 87 (2000); Garg et al., A unified framework for the numerical solution of optimal control problems
using pseudospectral methods, Automatica 46 (2010); Betts, Practical Methods for Optimal Control (2010),
section 4.11.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import integrals, lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.lazy_values import cached_property
from robotraj._util.sparse import csr_array
from robotraj.solution.costates.densities import Density, run_out, split
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.costates.stepped import stepped_duals
from robotraj.solvers.base import Multipliers
from robotraj.transcription.collocation.index_reduction import path_equalities
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.collocation import Collocation


def covectors(nlp: Nlp, w: Array, multipliers: Multipliers) -> tuple[PhaseDuals, ...]:
    """Map the multipliers of a solved NLP to the duals of every phase.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        The solution, in physical units.
    multipliers : Multipliers
        Multipliers of rows and variables, in physical units.

    Returns
    -------
    tuple of PhaseDuals
        Duals by this mapping for collocation, and by ``stepped`` for shooting and compressed collocation. The tuple is
        empty where invariants, or equalities with their rates, are imposed: costates are not unique then.
    """
    if any(phase.dae.invariants or path_equalities(phase) for phase in nlp.problem.phases):
        return ()
    rows, bounds = multipliers.rows, multipliers.bounds
    found = []
    for i, layout in enumerate(nlp.layouts):
        collocated = isinstance(layout.scheme, Collocation)
        found.append(_Phase(nlp, i, w, rows, bounds).duals() if collocated else stepped_duals(nlp, i, w, multipliers))
    return tuple(found)


@lru_cache(maxsize=1024)
def _integrals(nodes: tuple[float, ...], tau: tuple[float, ...]) -> Array:
    """Integrals of the Lagrange polynomials, the same on every interval of a scheme."""
    return integrals(np.array(nodes), np.array(tau))


class _Phase:
    """The arrays of one phase while its multipliers are mapped."""

    def __init__(self, nlp: Nlp, index: int, w: Array, rows: Array, bounds: Array) -> None:
        self.layout: PhaseLayout = nlp.layouts[index]
        self.schemes = [i.scheme for i in self.layout.intervals if isinstance(i.scheme, Collocation)]
        dae = nlp.problem.phases[index].dae
        self.nx, self.nz, self.nu = len(dae.states), len(dae.algebraic), len(dae.controls)
        self.ng = len(dae.residuals)
        block = nlp.blocks[index]
        self.stage = block.stage
        self.places = block.count
        self.nh = self.stage.outputs - self.nx - self.ng - 1
        self.breaks = self.layout.breaks(w)
        self.jacobians = self._jacobians(block, w)
        every = (block.scatter.T @ rows).reshape(self.places, self.stage.outputs)
        first = self.nx + self.ng
        self.weights = self._weights()
        self.residual = every[:, self.nx : first]
        self.path = split(every[:, first : first + self.nh], self.weights)
        self.bounds = bounds
        self.state_bounds = self._bound_density("states", self.nx)
        self.algebraic_bounds = self._bound_density("algebraic", self.nz)
        self._defects(nlp, index, rows)
        self._added_rows(nlp, block.scatter, rows)

    def _jacobians(self, block: object, w: Array) -> Array:
        """Dense dy/dv at every place, (places, n_y, n_v)."""
        r, c = self.stage.jacobian_pattern
        values = self.stage.jacobian.map(self.places)(block.places(w), block.constants)  # type: ignore[attr-defined]
        out = np.zeros((self.places, self.stage.outputs, self.stage.inputs))
        out[:, r, c] = np.array(values).reshape(len(r), self.places).T
        return out

    def _weights(self) -> Array:
        """Quadrature weight of each place [s], (places,)."""
        weights = np.zeros(self.places)
        for k, seconds in enumerate(self._seconds):
            np.add.at(weights, self.layout.intervals[k].places, seconds)
        return weights

    def _bound_density(self, group: str, size: int) -> Density:
        """Multipliers of the variables' bounds at the places.

        At an end of the phase, those of states contain the multipliers of the end conditions. Their densities are
        extrapolated from the points beside it, so that an arc may extend to the end.
        """
        values = np.zeros((self.places, size))
        for interval in self.layout.intervals:
            values[interval.places] = self.bounds[getattr(interval, group)]
        if group == "states":
            owners = self.layout.intervals
            if owners[0].scheme.nodes[0] == 0.0:
                values[0] = self.weights[0] * run_out(values[1:3] / self.weights[1:3, None])
            if owners[-1].scheme.nodes[-1] == 1.0:
                values[-1] = self.weights[-1] * run_out(values[-2:-4:-1] / self.weights[-2:-4:-1, None])
        return split(values, self.weights)

    def _defects(self, nlp: Nlp, index: int, rows: Array) -> None:
        """Multipliers of the defects of every interval, (targets, nx) each."""
        entries = nlp.rows.entries
        chosen = [i for i, e in enumerate(entries) if e.phase == index and e.name == "defect"]
        self.defect_rows = np.flatnonzero(np.isin(nlp.rows.meaning, chosen))
        counts = [int(np.sum(i.scheme.nodes > 0) + (i.scheme.nodes[-1] < 1)) for i in self.layout.intervals]
        flat = rows[self.defect_rows].reshape(-1, self.nx)
        self.defects = np.split(flat, np.cumsum(counts)[:-1])

    def _added_rows(self, nlp: Nlp, scatter: csr_array, rows: Array) -> None:
        """Rows between collocation points, by interval: tau, impulse and contributions to the stages."""
        rates = (np.arange(self.places)[:, None] * self.stage.outputs + np.arange(self.nx)).ravel()
        reading = csr_array(scatter.tocsc()[:, rates])
        others = np.setdiff1d(np.flatnonzero(np.diff(reading.indptr)), self.defect_rows)
        self.added_rows: dict[int, list[tuple[float, Array, Array]]] = {}
        knots = self.layout.mesh.knots
        for row in others:
            fraction = nlp.rows.fraction[row]
            k = int(np.clip(np.searchsorted(knots, fraction) - 1, 0, len(knots) - 2))
            interval = self.layout.intervals[k]
            dense = reading[[row]].toarray().reshape(self.places, self.nx)[interval.places]
            impulse = rows[row] * np.asarray(nlp.linear[[row]].toarray()).ravel()[interval.left]
            tau = (fraction - knots[k]) / (knots[k + 1] - knots[k])
            self.added_rows.setdefault(k, []).append((tau, impulse, rows[row] * dense))

    def duals(self) -> PhaseDuals:
        """Map interval by interval."""
        nodes = [interval.scheme.nodes for interval in self.layout.intervals]
        stages = [self._stage_costates(k) for k in range(len(nodes))]
        nu = self._residual_shares(stages)
        breaks, sites, values = [self.breaks[0]], [], []
        for k in range(len(self.layout.intervals)):
            pushes = self._pushes(k, stages[k], nu[k])
            start = -self.defects[k].sum(axis=0) + sum(
                (row[1] for row in self.added_rows.get(k, ())), np.zeros(self.nx)
            )
            if nodes[k][0] == 0.0:
                start = start + pushes[0]
            cuts, jumps = self._impulses(k)
            rates = pushes / self.schemes[k].weights[:, None]
            low = 0.0
            for tau, jump in zip([*cuts, 1.0], [*jumps, None], strict=True):
                inner = lobatto_sites(len(nodes[k]) + 1)
                values.append(start - _integrals(tuple(nodes[k]), tuple(low + (tau - low) * inner)) @ rates)
                sites.append(inner)
                breaks.append(self.breaks[k] + tau * (self.breaks[k + 1] - self.breaks[k]))
                start, low = (start if jump is None else start - jump), tau
        seconds = self._seconds

        def at_nodes(per_place: Array) -> PiecewisePolynomial:
            each = [per_place[interval.places] for interval in self.layout.intervals]
            return PiecewisePolynomial(self.breaks, nodes, each)

        residual = [n / s[:, None] for n, s in zip(nu, seconds, strict=True)]
        return PhaseDuals(
            PiecewisePolynomial(np.array(breaks), sites, values),
            PiecewisePolynomial(self.breaks, nodes, residual),
            at_nodes(self.path.density),
            at_nodes(self.state_bounds.density),
            at_nodes(self.algebraic_bounds.density),
            self._control_bounds(seconds),
        )

    @cached_property
    def _seconds(self) -> list[Array]:
        """Quadrature weight of every node [s], by interval."""
        return [h * scheme.weights for h, scheme in zip(np.diff(self.breaks), self.schemes, strict=True)]

    def _stage_costates(self, k: int) -> Array:
        """Lambda of every stage of interval k, (s, nx)."""
        scheme, mu = self.schemes[k], self.defects[k]
        reached = scheme.matrix[scheme.nodes > 0.0]
        coefficients = -(reached.T @ mu[: len(reached)])
        if scheme.nodes[-1] < 1.0:
            coefficients -= scheme.weights[:, None] * mu[-1]
        length = self.layout.intervals[k].clock.length
        for _, _, reads in self.added_rows.get(k, ()):
            coefficients += reads / length
        return coefficients / scheme.weights[:, None]

    def _shares(self, k: int) -> Array:
        """Part of each place's quadrature weight that belongs to interval k, (s,)."""
        return self._seconds[k] / self.weights[self.layout.intervals[k].places]

    def _gradient(self, k: int, columns: slice, stage: Array) -> Array:
        """Weighted gradient of l + Lambda' f + eta' h by v[columns] at the nodes of interval k, (s, .)."""
        interval = self.layout.intervals[k]
        scheme, length = self.schemes[k], interval.clock.length
        parts = self.jacobians[interval.places][:, :, columns]
        out = length * scheme.weights[:, None] * np.einsum("ji,jik->jk", stage, parts[:, : self.nx])
        out += length * scheme.objective_weights[:, None] * parts[:, -1]
        first = self.nx + self.ng
        seconds = (self.breaks[k + 1] - self.breaks[k]) * scheme.weights
        eta = self.path.density[interval.places] * seconds[:, None]
        return out + np.einsum("ji,jik->jk", eta, parts[:, first : first + self.nh])

    def _residual_shares(self, stages: list[Array]) -> list[Array]:
        """Multipliers of the algebraic rows, split at shared places so that each side is stationary in z."""
        nu = [self.residual[i.places] * self._shares(k)[:, None] for k, i in enumerate(self.layout.intervals)]
        if not self.nz or self.nz != self.ng:
            return nu
        columns = slice(self.nx, self.nx + self.nz)
        for k in range(len(stages) - 1):
            left, right = self.layout.intervals[k], self.layout.intervals[k + 1]
            place = left.places[-1]
            if place != right.places[0]:
                continue
            matrix = self.jacobians[place][self.nx : self.nx + self.ng, columns]
            if np.linalg.matrix_rank(matrix) < self.nz:
                continue
            share = self._shares(k)[-1]
            sides = [
                self._gradient(k, columns, stages[k])[-1],
                self._gradient(k + 1, columns, stages[k + 1])[0],
            ]
            wanted = share * (sides[0] + sides[1]) - sides[0]
            shift = np.linalg.solve(matrix.T, wanted)
            nu[k][-1] += shift
            nu[k + 1][0] -= shift
        return nu

    def _pushes(self, k: int, stage: Array, nu: Array) -> Array:
        """Quadrature weight times H_x at the nodes of interval k, (s, nx)."""
        interval = self.layout.intervals[k]
        columns = slice(0, self.nx)
        parts = self.jacobians[interval.places][:, self.nx : self.nx + self.ng, columns]
        seconds = (self.breaks[k + 1] - self.breaks[k]) * self.schemes[k].weights
        bounds = self.state_bounds.density[interval.places] * seconds[:, None]
        return self._gradient(k, columns, stage) + np.einsum("ji,jik->jk", nu, parts) + bounds

    def _impulses(self, k: int) -> tuple[list[float], list[Array]]:
        """Places strictly inside interval k where the costate jumps, ascending, and by how much it falls."""
        interval = self.layout.intervals[k]
        found = [(tau, impulse) for tau, impulse, _ in self.added_rows.get(k, ())]
        for place, tau in zip(interval.places, interval.scheme.nodes, strict=True):
            if 0.0 < tau < 1.0:
                jump = self.state_bounds.impulse[place] + self._path_impulse(place)
                if np.any(jump):
                    found.append((float(tau), jump))
        found.sort(key=lambda pair: pair[0])
        return [tau for tau, _ in found], [jump for _, jump in found]

    def _path_impulse(self, place: int) -> Array:
        first = self.nx + self.ng
        return self.path.impulse[place] @ self.jacobians[place][first : first + self.nh, : self.nx]

    def _control_bounds(self, seconds: list[Array]) -> PiecewisePolynomial:
        """Densities of the controls' bounds at the control's sites, weighted by the integrals of their polynomials."""
        weights: dict[int, float] = {}
        served = [s @ scheme.control_at_nodes for s, scheme in zip(seconds, self.schemes, strict=True)]
        for interval, part in zip(self.layout.intervals, served, strict=True):
            for site, columns in enumerate(interval.controls):
                for column in columns:
                    weights[int(column)] = weights.get(int(column), 0.0) + float(part[site])
        values = []
        for interval in self.layout.intervals:
            each = np.array([[weights[int(c)] for c in columns] for columns in interval.controls])
            each = each.reshape(len(interval.controls), self.nu)
            values.append(self.bounds[interval.controls] / np.where(each > 0, each, 1.0))
        sites = [interval.scheme.control_sites for interval in self.layout.intervals]
        return PiecewisePolynomial(self.breaks, sites, values)
