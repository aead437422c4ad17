"""Duals of a phase as functions of time."""

from __future__ import annotations

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True, eq=False)
class PhaseDuals(OneLine):
    """Duals of one phase, in global time, for the Hamiltonian H = l + lambda' f + nu' g + eta' h.

    Attributes
    ----------
    costate : PiecewisePolynomial
        lambda, one per state; it may jump at its breaks.
    residual : PiecewisePolynomial
        nu, one per algebraic row.
    path : PiecewisePolynomial
        Densities eta of the rows held throughout that are not single variables; positive at an upper bound.
    states, algebraic, controls : PiecewisePolynomial
        Densities of the bounds of the variables at the nodes; positive at an upper bound.
    """

    costate: PiecewisePolynomial
    residual: PiecewisePolynomial
    path: PiecewisePolynomial
    states: PiecewisePolynomial
    algebraic: PiecewisePolynomial
    controls: PiecewisePolynomial
