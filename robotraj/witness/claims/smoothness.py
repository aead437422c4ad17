"""Controls do not alternate with the mesh: a drive follows no teeth."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "smoothness",
    "second differences of the planned controls at the knots and in the middle of the intervals",
    "no torque or other control alternates with the mesh by more than a share of its limit",
    "switches and other fast changes that the mesh resolves, vibrations of the machine",
)


def smoothness(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on the teeth of controls; None where no control has limits."""
    if figures.was_late("smoothness"):
        return SCOPE.unknown(LATE)
    found, allowed = figures.teeth, tolerances.smoothness
    if found is None:
        return None
    if allowed is None:
        return SCOPE.unknown("No threshold was given.", found.relative)
    if found.relative <= allowed:
        return SCOPE.judged([], found.relative, allowed)
    wrong = (
        f"The planned {found.control} in phase {found.phase!r} alternates with the mesh by "
        f"{100 * found.relative:.2g} percent of its limit"
    )
    if figures.proof is None:
        why = f"{wrong}: on a mesh of one's own the controls between its points are not chosen."
        return SCOPE.unknown(why, found.relative, allowed)
    return SCOPE.judged([f"{wrong}; {100 * allowed:.2g} percent are allowed."], found.relative, allowed)
