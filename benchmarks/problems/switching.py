"""Bang-bang problems on knots that move, with their exact switching times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

import robotraj as rt

from .case import Case
from .written import TABLE, written


@dataclass(frozen=True)
class Bang:
    """A problem, its moving mesh and the times at which its controls jump [s].

    Attributes
    ----------
    case : Case
    mesh : MovingMesh
    switches : mapping of str to tuple of float
        By control.
    accuracy : float
        Of the times [s].
    """

    case: Case
    mesh: rt.schemes.MovingMesh
    switches: Mapping[str, tuple[float, ...]]
    accuracy: float


def bangs() -> list[Bang]:
    """Return the two-link arm (arcs integrated to 1e-12, printed to 1e-5) and the S-curve (closed form)."""
    cases = {case.name: case for case in written(TABLE)}
    constant = rt.schemes.ConstantControl()
    arm = {"u1": (1.49114,), "u2": (0.94314, 2.62755)}
    jerk = {"j": (0.1, 0.5, 0.6, 2.0, 2.1, 2.5)}
    return [
        Bang(cases["two_link_arm"], rt.schemes.MovingMesh(20, rt.schemes.RadauIIA(5, control=constant)), arm, 1e-5),
        Bang(
            cases["min_time_bvp_jerk"], rt.schemes.MovingMesh(10, rt.schemes.RadauIIA(3, control=constant)), jerk, 0.0
        ),
        Bang(
            cases["double_integrator"],
            rt.schemes.MovingMesh(5, rt.schemes.RadauIIA(2, control=constant)),
            {"u": (np.sqrt(10),)},
            0.0,
        ),
    ]


def plan(bang: Bang) -> rt.Solution:
    """Solve on the moving mesh from the case's guess."""
    solver = rt.Ipopt(tolerance=1e-10)
    return rt.plan(bang.case.problem, bang.mesh, bang.case.guess, solver, progress=False)


def arcs(solution: rt.Solution, control: str) -> list[tuple[float, float]]:
    """End and value of every arc of a control that is constant in intervals."""
    knots = solution.knots
    values = solution.at(0.5 * (knots[1:] + knots[:-1])).u[control]
    ends = np.append(np.abs(np.diff(values)) > 1e-2 * np.ptp(values), True)
    return [(float(end), float(value)) for end, value in zip(knots[1:][ends], values[ends], strict=True)]
