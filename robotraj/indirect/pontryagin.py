"""Pontryagin's equations on an arc, as a System of states and costates.

    xdot = f,   lambdadot = -H_x,   hdot = H_t,   Jdot = l,
    0 = H_u for interior controls,   0 = H_z,   0 = g;   controls at a bound are constants

The value h of the Hamiltonian and the cost J so far are additional states. Conditions on the duration and the
objective are then boundary conditions of states.

Source: Bryson and Ho, Applied Optimal Control (1975), chapters 2 and 3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import casadi as ca

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.point import Point
from robotraj.dynamics.rigid_body_forms import ForwardDynamics, InverseDynamics
from robotraj.dynamics.system import System
from robotraj.dynamics.variable import Named, Scalar
from robotraj.indirect.arcs import Side
from robotraj.problem.phase import Phase
from robotraj.solution.costates.hamiltonian import Hamiltonian


@dataclass(frozen=True, eq=False)
class Pontryagin(OneLine):
    """Pontryagin's equations of a phase, on arcs.

    Attributes
    ----------
    original : Phase
        The phase. A robot has forward dynamics here: fewer unknowns, the same costates.
    parameters : ndarray
        Values of the phase's parameters.
    bounds : ndarray (2, nu)
        Lower and upper bounds of the controls.
    """

    original: Phase
    parameters: Array
    bounds: Array

    @cached_property
    def phase(self) -> Phase:
        """The phase with a robot's equations solved for the accelerations."""
        dynamics = self.original.dynamics
        if isinstance(dynamics, InverseDynamics):
            return replace(self.original, dynamics=ForwardDynamics(dynamics.softening))
        return self.original

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """H of the phase."""
        return Hamiltonian.of(self.phase)

    @cached_property
    def state_names(self) -> list[str]:
        """States of an arc: x, costates, the Hamiltonian and the cost so far."""
        names = [s.name for s in self.phase.dae.states]
        return [*(f"x {n}" for n in names), *(f"costate {n}" for n in names), "hamiltonian", "cost"]

    @property
    def nx(self) -> int:
        """Number of states of the phase."""
        return len(self.phase.dae.states)

    def interior(self, sides: Sequence[Side]) -> list[int]:
        """Return the indices of the interior controls."""
        return [i for i, side in enumerate(sides) if side is Side.INTERIOR]

    def algebraic_names(self, sides: Sequence[Side]) -> list[str]:
        """Algebraic variables of an arc: interior controls, then z and nu of a DAE."""
        dae = self.phase.dae
        controls = [f"u {dae.controls[i].name}" for i in self.interior(sides)]
        return [*controls, *(f"z {v.name}" for v in dae.algebraic), *(f"nu {r.name}" for r in dae.residuals)]

    def controls(self, sides: Sequence[Side], interior: Sequence[ca.SX] | Array) -> list[Scalar | Array]:
        """Return all controls of an arc; ``interior`` holds the values of the interior ones in order."""
        which = self.interior(sides)
        values: list[Scalar | Array] = []
        for i, side in enumerate(sides):
            values.append(interior[which.index(i)] if i in which else float(self.bounds[int(side is Side.UPPER), i]))
        return values

    @cached_property
    def _outputs(self) -> ca.Function:
        """(t, x, lambda, z, nu, u) -> state rates, H_u, H_z, g, H."""
        h, s = self.hamiltonian, self.hamiltonian.symbols
        e = h.expressions
        rates = ca.vertcat(e["rates"], -h.gradient("x"), h.gradient("t"), e["integrand"])
        outputs = [rates, h.gradient("u"), h.gradient("z"), e["residual"], e["hamiltonian"]]
        outputs = ca.substitute(
            [ca.densify(o) for o in outputs],
            [s["p"], s["eta"]],
            [ca.SX(ca.DM(self.parameters)), ca.SX.zeros(s["eta"].numel())],
        )
        names = ["rates", "by_u", "by_z", "residual", "H"]
        return ca.Function(
            "pontryagin",
            [s[n] for n in ("t", "x", "costate", "z", "nu", "u")],
            outputs,
            ["t", "x", "costate", "z", "nu", "u"],
            names,
        )

    def end_cost(self, t0: float, x0: Array, tf: float, xf: Array) -> float:
        """Return the value of the Mayer terms."""
        nx, phase = self.nx, self.phase
        symbols = [ca.SX.sym("t0"), ca.SX.sym("x0", nx), ca.SX.sym("tf"), ca.SX.sym("xf", nx)]
        p = ca.SX(ca.DM(self.parameters))
        pairs = (symbols[:2], symbols[2:])
        start, end = (phase.dae.point(t, x, None, None, p, phase.parameter_names) for t, x in pairs)
        value = sum((w * as_rows(t.value(start, end), "Mayer expression")[0] for w, t in phase.end_costs), ca.SX(0))
        return float(ca.Function("mayer", symbols, [value])(t0, x0, tf, xf))

    def evaluate(self, t: Scalar, y: ca.SX, a: ca.SX, sides: Sequence[Side]) -> dict[str, ca.SX]:
        """Return the outputs for symbols y, the states, and a, the algebraic variables of an arc."""
        nx, nu = self.nx, len(self.interior(sides))
        nz = len(self.phase.dae.algebraic)
        u = ca.vertcat(*(ca.SX(value) for value in self.controls(sides, [a[i] for i in range(nu)])))
        x, costate, z, multipliers = y[:nx], y[nx : 2 * nx], a[nu : nu + nz], a[nu + nz :]
        values = self._outputs(t, x, costate, z, multipliers, u)
        return dict(zip(self._outputs.name_out(), values, strict=True)) | {"u": u}

    def equations(self, t: Scalar, y: ca.SX, a: ca.SX, sides: Sequence[Side]) -> tuple[ca.SX, ca.SX]:
        """Return the rates of the states and the algebraic rows of an arc."""
        out = self.evaluate(t, y, a, sides)
        interior = [out["by_u"][i] for i in self.interior(sides)]
        return out["rates"], ca.vertcat(*interior, out["by_z"], out["residual"])

    def system(self, sides: Sequence[Side]) -> System:
        """Return the equations of an arc as a System."""
        states, algebraic = self.state_names, self.algebraic_names(sides)

        def read(point: Point) -> tuple[ca.SX, ca.SX]:
            y, a = columns(point.x, states), columns(point.z, algebraic)
            return self.equations(point.t, y, a, sides)

        residual = (lambda point: read(point)[1]) if algebraic else None
        return System(states, [], lambda point: read(point)[0], algebraic=algebraic, residual=residual, name="arc")

    def quantity(self, name: str, index: int | None, sides: Sequence[Side]) -> Callable[[Point], ca.SX]:
        """Return an output as an expression of a point of an arc: ``"H"``, or entry ``index`` of ``"by_u"``."""

        def expression(point: Point) -> ca.SX:
            y = columns(point.x, self.state_names)
            value = self.evaluate(point.t, y, columns(point.z, self.algebraic_names(sides)), sides)[name]
            return value if index is None else value[index]

        return expression


def columns(named: Named[Scalar], names: Sequence[str]) -> ca.SX:
    """Return named scalars as a column."""
    return ca.vertcat(*(ca.SX(named[name]) for name in names)) if names else ca.SX(0, 1)
