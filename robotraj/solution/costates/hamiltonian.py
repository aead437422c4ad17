"""The Hamiltonian of a phase and its derivatives.

    H(t, x, z, u, p, lambda, nu, eta) = l + lambda' f + nu' g + eta' h

Here l is the integrand of the objective, f are the rates, g the algebraic rows and h the path rows. The integrands of
integral constraints are the last entries of h; their eta is constant. H along a trajectory is evaluated without eta' h
of path rows: h measured from the bound vanishes where a row is active.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.row import Row
from robotraj.problem.phase import Phase

ARGUMENTS = ("t", "x", "z", "u", "p", "costate", "nu", "eta")


@dataclass(frozen=True)
class Hamiltonian(OneLine):
    """The Hamiltonian of a phase under given dynamics: its own, or others of the same states and controls."""

    phase: Phase
    dae: Dynamics

    @staticmethod
    def of(phase: Phase) -> Hamiltonian:
        """By the dynamics that were transcribed."""
        return Hamiltonian(phase, phase.dae)

    @cached_property
    def path(self) -> tuple[Row, ...]:
        """Rows held throughout that are not single variables, in the order of eta."""
        return self.phase.rows.path

    @cached_property
    def integrals(self) -> tuple[Row, ...]:
        """Rows of integrals over the phase: their multipliers, which are constant, come last in eta."""
        return self.phase.rows.integrals

    @cached_property
    def symbols(self) -> dict[str, ca.SX]:
        """Symbols of the arguments."""
        dae = self.dae
        sizes = (1, len(dae.states), len(dae.algebraic), len(dae.controls), len(self.phase.parameter_names))
        more = (len(dae.states), len(dae.residuals), len(self.path) + len(self.integrals))
        return {name: ca.SX.sym(name, n) for name, n in zip(ARGUMENTS, (*sizes, *more), strict=True)}

    @cached_property
    def expressions(self) -> dict[str, ca.SX]:
        """Rates f, residual g, path rows h, integrand l and H, symbolic."""
        s = self.symbols
        point = self.dae.point(s["t"], s["x"], s["z"], s["u"], s["p"], self.phase.parameter_names)
        integrand = ca.SX(0)
        for weight, term in self.phase.integrals:
            integrand += weight * as_rows(term.rate(point), "integrand")[0]
        rates, residual = self.dae.rates(point), self.dae.residual(point)
        table = self.phase.rows
        path = table.column(table.path, point)
        rows = ca.vertcat(path, table.column(table.integrals, point))
        h = integrand + ca.dot(s["costate"], rates) + ca.dot(s["nu"], residual) + ca.dot(s["eta"], rows)
        known = {"rates": rates, "residual": residual, "path": path, "rows": rows, "integrand": integrand}
        return known | {"hamiltonian": h}

    def _sizes(self) -> dict[str, ca.SX]:
        """Add the magnitudes of the terms of H, without the path rows', and of those of its gradient by u."""
        s, e = self.symbols, self.expressions
        weighed = [(e["rates"], s["costate"]), (e["residual"], s["nu"]), (e["rows"], s["eta"])]
        size, by_u = ca.fabs(e["integrand"]), ca.fabs(ca.gradient(e["integrand"], s["u"]))
        for values, multipliers in weighed:
            by_u += ca.mtimes(ca.fabs(ca.jacobian(values, s["u"])).T, ca.fabs(multipliers))
            size += ca.dot(ca.fabs(values), ca.fabs(multipliers))
        size -= sum(ca.fabs(s["eta"][i] * e["path"][i]) for i in range(len(self.path)))
        return {"size": size, "size_by_u": by_u}

    def gradient(self, name: str) -> ca.SX:
        """Gradient of H by an argument, symbolic."""
        return ca.densify(ca.gradient(self.expressions["hamiltonian"], self.symbols[name]))

    @cached_property
    def _function(self) -> ca.Function:
        eta, path = self.symbols["eta"], self.expressions["path"]
        value = self.expressions["hamiltonian"] - sum(eta[i] * path[i] for i in range(len(self.path)))
        outputs = {"H": value, "path": self.expressions["path"]}
        outputs |= {f"by_{name}": self.gradient(name) for name in ("t", "x", "z", "u", "p")}
        outputs |= self._sizes()
        outputs["curvature"] = ca.diag(ca.hessian(self.expressions["hamiltonian"], self.symbols["u"])[0])
        values = [ca.densify(value) for value in outputs.values()]
        return ca.Function("hamiltonian", list(self.symbols.values()), values, list(ARGUMENTS), list(outputs))

    def __call__(self, **columns: Array) -> dict[str, Array]:
        """Evaluate at m times, arguments (m, n): H (m,) without eta' h of path rows, gradients ``by_x`` ... (m, n).

        ``size`` and ``size_by_u`` are the magnitudes of the terms of H and of ``by_u``, added up.
        """
        m = len(columns["t"])
        arguments = [np.asarray(columns[name], dtype=float).reshape(m, -1).T for name in ARGUMENTS]
        mapped = self._function.map(m)(*arguments)
        names = self._function.name_out()
        out = {name: np.array(value).reshape(-1, m).T for name, value in zip(names, mapped, strict=True)}
        out["H"] = out["H"][:, 0]
        return out

    @property
    def autonomous(self) -> bool:
        """Whether H does not depend on time explicitly."""
        return not ca.depends_on(self.expressions["hamiltonian"], self.symbols["t"])
