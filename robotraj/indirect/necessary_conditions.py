"""Pontryagin's necessary conditions, evaluated along a direct solution at its collocation points.

    lambdadot = -H_x,   H_u = 0, or of the sign that an active bound requires,
    lambda(tf) = dPhi/dxf,   lambda(t0) = -dPhi/dx0,
    dH/dt = partial H / partial t,   H(tf) = -dPhi/dtf for a free duration,   multiplier * slack = 0

Source: Bryson and Ho, Applied Optimal Control (1975), chapters 2 and 3; Betts, Practical Methods for
Optimal Control (2010), chapter 4.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import integrals
from robotraj._util.errors import InputError, require_solution
from robotraj.dynamics.variable import Variable
from robotraj.indirect.arcs import control_bounds
from robotraj.indirect.boundary import end_data, potential
from robotraj.indirect.checks import ACTIVE_DISTANCE, ThroughoutRows
from robotraj.indirect.costate_trajectory import PhaseCostates, costates
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.indirect.report import ConditionsReport, NecessaryCondition
from robotraj.problem.phase_row import Kind
from robotraj.solution.solution import Solution

SMALL = 1e-12
"""Added to denominators that may be zero."""


def conditions(solution: Solution, tolerance: float = 1e-2) -> ConditionsReport:
    """Evaluate the necessary conditions along a solution.

    Parameters
    ----------
    solution : Solution
        The solution, by any collocation scheme.
    tolerance : float
        Largest residual, relative to the size of a condition's terms, of a satisfied condition. The residuals
        decrease with the mesh at the order of the costates, which is below that of the states between the knots.

    Returns
    -------
    ConditionsReport
        ``print(report)`` is a table by state, control and time; ``.passed``, ``.failed``, ``.check()``.

    Raises
    ------
    InputError
        The solution has no costates (see ``rt.indirect.costates``).
    """
    require_solution(solution, "rt.indirect.conditions")
    if not tolerance > 0:
        raise InputError(f"conditions(tolerance) must be above 0, got {tolerance}.")
    linked = {i for link in solution.problem.bound_links for i in link.phases}
    found: list[NecessaryCondition] = []
    for i, part in enumerate(costates(solution).phases):
        found += _PhaseConditions(part, i in linked).conditions()
    return ConditionsReport(tuple(found), tolerance)


class _PhaseConditions:
    """Residuals of the conditions along one phase, at the nodes of its intervals."""

    def __init__(self, known: PhaseCostates, linked: bool) -> None:
        self.known, self.linked = known, linked
        self.solution, self.phase = known.solution, known.solution.phase
        self.dae = self.phase.dae
        knots, sites = self.solution.knots, known.duals.residual.sites
        self.intervals = [a + (b - a) * s for a, b, s in zip(knots[:-1], knots[1:], sites, strict=True)]
        each = [known.evaluate(t, k) for k, t in enumerate(self.intervals)]
        self.at = {name: np.concatenate([part[name] for part in each]) for name in each[0]}

    def conditions(self) -> list[NecessaryCondition]:
        """Return the entries of the report."""
        return [
            *self._costate_equation(),
            *self._controls(),
            *self._transversality(),
            *self._hamiltonian(),
            *self._complementarity(),
        ]

    def _line(self, name: str, variable: Variable | str, residual: Array | float, note: str = "") -> NecessaryCondition:
        """Return the entry of residuals at the nodes, (m,), or of one residual at the end."""
        label = variable if isinstance(variable, str) else variable.name
        if np.ndim(residual) == 0:
            end = self.solution.t0 + self.solution.duration
            return NecessaryCondition(self.phase.name, name, label, float(residual), end, note)
        values = np.asarray(residual)
        worst = int(np.argmax(values))
        return NecessaryCondition(self.phase.name, name, label, float(values[worst]), float(self.at["t"][worst]), note)

    def _costate_equation(self) -> list[NecessaryCondition]:
        """Compare the rate of the costates with -H_x; H includes active bounds with their multipliers."""
        slope = self.known.duals.costate.derivative()
        nudge = 1e-9 * self.solution.duration
        rates = np.vstack([slope(np.clip(t, t[0] + nudge, t[-1] - nudge)) for t in self._inner()])
        push = self.at["by_x"] + self.at["states"]
        size = np.max(np.abs(push), axis=0) + np.max(np.abs(self.at["costate"]), axis=0) / self.solution.duration
        off = np.abs(rates + push) / (size + SMALL)
        return [self._line("costate equation", s, off[:, i]) for i, s in enumerate(self.dae.states)]

    def _inner(self) -> list[Array]:
        """Return the nodes, those at knots moved slightly into their intervals, since costates may jump at a knot."""
        knots = self.solution.knots
        parts = zip(self.intervals, knots[:-1], knots[1:], strict=True)
        return [np.clip(t, a + 1e-7 * (b - a), b - 1e-7 * (b - a)) for t, a, b in parts]

    def _controls(self) -> list[NecessaryCondition]:
        """Check dH/du: zero where a control is between its bounds, of the required sign where it is at one."""
        slope = self.at["by_u"]
        size = np.max(self.at["size_by_u"], axis=0) + SMALL
        lower, upper = control_bounds(self.phase)
        found = []
        for i, control in enumerate(self.dae.controls):
            u = self.at["u"][:, i]
            width = np.nan_to_num(upper[i] - lower[i], posinf=0.0) + 1.0
            low, high = u <= lower[i] + 1e-5 * width, u >= upper[i] - 1e-5 * width
            inside = ~(low | high)
            off = slope[:, i] / size[i]
            share = f"{np.mean(inside):.0%} inside, {np.mean(low):.0%} at lower, {np.mean(high):.0%} at upper"
            found.append(self._line("stationarity", control, np.where(inside, np.abs(off), 0.0), share))
            if not np.all(inside):
                wrong = np.where(low, -off, np.where(high, off, 0.0))
                note = "dH/du >= 0 at lower, <= 0 at upper bound"
                found.append(self._line("saturation", control, np.maximum(wrong, 0.0), note))
        return found

    def _transversality(self) -> list[NecessaryCondition]:
        """Compare costates at free ends with the gradient of the end costs and end constraints."""
        if self.linked:
            return []
        parameters = np.array(list(self.solution.parameters.values()), dtype=float)
        equations = Pontryagin(self.phase, parameters, np.array(control_bounds(self.phase)))
        x, t0, tf = self.solution.trajectory.x, self.solution.t0, self.solution.t0 + self.solution.duration
        x0, xf = x(t0, 0), x(tf)
        ends = end_data(equations, x0, xf, self.solution.duration)
        phi, symbols = potential(equations, ends)
        gradient = ca.vertcat(*(ca.gradient(phi, symbols[name]) for name in ("x0", "xf", "tf")))
        pi = symbols["pi"]
        function = ca.Function("phi", list(symbols.values()), [ca.densify(gradient), ca.jacobian(gradient, pi)])
        value, matrix = (np.array(v) for v in function(t0, x0, tf, xf, np.zeros(pi.numel())))
        hamiltonian = float(self.at["H"][-1])
        wanted = np.concatenate([-self.known.initial, self.known.final, [-hamiltonian]]) - value.ravel()
        free = np.isnan(np.concatenate([ends.start, ends.end, [np.nan if ends.time is None else 0.0]]))
        if pi.numel():
            wanted = wanted - matrix @ np.linalg.lstsq(matrix[free], wanted[free], rcond=None)[0]
        size = np.max(np.abs(self.at["costate"]), axis=0) + SMALL
        scale = np.concatenate([size, size, [self._size() + SMALL]])
        nx = len(self.dae.states)
        labels = [f"{s.name} at the {end}" for end in ("start", "end") for s in self.dae.states] + ["final time"]
        off = np.abs(wanted) / scale
        found = []
        for i in np.flatnonzero(free):
            note = f"H = {hamiltonian:.6g} at the end" if i == 2 * nx else ""
            line = self._line("transversality", labels[i], float(off[i]), note)
            start = NecessaryCondition(line.phase, line.name, line.label, line.residual, t0, line.note)
            found.append(start if i < nx else line)
        return found

    def _size(self) -> float:
        """Return the largest size of the Hamiltonian's terms."""
        return float(np.max(self.at["size"]))

    def _hamiltonian(self) -> list[NecessaryCondition]:
        """Check that dH/dt = partial H / partial t; for an autonomous phase H is constant."""
        drift = self.at["H"]
        note = f"constant: {np.min(drift):.6g} to {np.max(drift):.6g}"
        if not self.known.hamiltonian.autonomous:
            drift = drift - self._explicit_change()
            note = "minus the integral of partial H / partial t"
        off = np.abs(drift - np.median(drift)) / (self._size() + SMALL)
        return [self._line("Hamiltonian", "H", off, note)]

    def _explicit_change(self) -> Array:
        """Return the integral of partial H / partial t from the start to every node, (m,)."""
        total, values, first = 0.0, [], 0
        for t, a, b, sites in zip(
            self.intervals,
            self.solution.knots[:-1],
            self.solution.knots[1:],
            self.known.duals.residual.sites,
            strict=True,
        ):
            rate = self.at["by_t"][first : first + len(t), 0]
            values.append(total + (b - a) * integrals(sites, sites) @ rate)
            total += float((b - a) * integrals(sites, np.array([1.0]))[0] @ rate)
            first += len(t)
        return np.concatenate(values)

    def _complementarity(self) -> list[NecessaryCondition]:
        """Compare the product of multiplier and slack of every row with the Hamiltonian's terms."""
        at, found = self.at, []
        names = {
            **{v.name: at["states"][:, i] for i, v in enumerate(self.dae.states)},
            **{v.name: at["algebraic"][:, i] for i, v in enumerate(self.dae.algebraic)},
            **{v.name: at["controls"][:, i] for i, v in enumerate(self.dae.controls)},
        }
        parameters = np.array(list(self.solution.parameters.values()), dtype=float)
        size = self._size() + SMALL
        path = 0
        for row, value in ThroughoutRows(self.phase, parameters)(at["t"], at["x"], at["z"], at["u"]):
            if row.kind is not Kind.BOUND:
                multiplier = at["eta"][:, path]
                path += 1
            else:
                multiplier = names[self.phase.rows.variable_of(row).name]
            below, above = value - row.lower, row.upper - value
            slack = np.where(multiplier > 0, above, below)
            # Without a bound on this side every multiplier is an error; its weight is the size of the value.
            slack = np.where(np.isinf(slack), 1.0 + np.abs(value), np.abs(slack))
            product = slack * np.abs(multiplier) / size
            active = np.mean(np.minimum(below, above) <= ACTIVE_DISTANCE * (1.0 + np.abs(value)))
            found.append(self._line("complementarity", row.label, product, f"active on {active:.0%}"))
        return found
