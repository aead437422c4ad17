"""The planned torques and forces are those of the planned motion, in proportion to each joint's own load."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "torques",
    "Pinocchio's inverse dynamics of the planned motion, integrated over short windows",
    "motor torques and contact forces give the planned motion, each to a share of the joint's own load, and planned "
    "velocities are the derivatives of planned positions",
    "forces between two collocation points that cancel over a window; masses and inertias of the file",
)


def torques(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on torques, forces and energy; None for a plan that moves no robot."""
    if not figures.moves_robot:
        return None
    found = figures.torques
    if found is None:
        return SCOPE.unknown(LATE)
    figure = max(found.relative, 0.0 if figures.rates is None else figures.rates.relative)
    wrong = []
    if tolerances.torques is not None and found.relative > tolerances.torques:
        wrong.append(
            f"The planned torques and forces are not those of the planned motion: {found}, the "
            f"joint's load, in the mean over a window of phase {found.phase!r}; "
            f"{100 * tolerances.torques:.2g} percent are allowed."
        )
    rates = figures.rates
    if tolerances.torques is not None and rates is not None and rates.relative > tolerances.torques:
        wrong.append(
            f"The planned velocity of {rates.joint} is not the derivative of its position: {rates.amount:.3g} "
            f"{rates.unit} off in the mean over a window up to t = {rates.time:.4g} s in phase {rates.phase!r}, "
            f"{tolerances.torques * rates.size:.3g} is allowed."
        )
    energy = figures.energy
    if tolerances.energy is not None and energy is not None and energy.relative > tolerances.energy:
        wrong.append(
            f"The energy balance is off by {energy.imbalance:.3g} J, {energy.relative:.3g} of the energy "
            f"that moved, worst in the interval from t = {energy.time:.4g} s; "
            f"{tolerances.energy:.3g} is allowed."
        )
    if tolerances.torques is None and not wrong:
        return SCOPE.unknown("No threshold was given.", figure)
    return SCOPE.judged(wrong, figure, tolerances.torques)
