"""A mass pushed along a line, in pieces."""

from __future__ import annotations

from typing import Any

import pytest

import robotraj as rt

MASS = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], units={"x": "m", "v": "m/s", "u": "N"})


class Push:
    """Builds phases of the mass that cost the integral of u^2.

    From rest over the distance d to the speed w in the time T that is  12 d^2 / T^3 - 12 d w / T^2 + 4 w^2 / T.
    """

    system = MASS
    solver = rt.Ipopt(tolerance=1e-11)
    mesh = rt.Mesh(6)

    def phase(self, duration: Any = 1.0, start: Any = None, end: Any = None, **more: Any) -> rt.Phase:
        ends = (None if state is None else rt.State(state) for state in (start, end))
        given = {"objective": rt.Lagrange(lambda point: point.u["u"] ** 2)} | more
        return rt.Phase(MASS, duration, *ends, **given)

    def plan(self, phases: Any, links: Any, mesh: Any = None) -> rt.Solution:
        return rt.plan(rt.Problem(phases, links), mesh or self.mesh, solver=self.solver)

    @staticmethod
    def cost(d: float, w: float, T: float = 1.0) -> float:
        return 12 * d**2 / T**3 - 12 * d * w / T**2 + 4 * w**2 / T


@pytest.fixture(scope="session")
def push() -> Push:
    return Push()
