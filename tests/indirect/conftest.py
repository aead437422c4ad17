"""Problems with closed-form costates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import robotraj as rt


@dataclass(frozen=True)
class Known:
    """A phase for a start state, and its exact costates (m, 2) at times (m,)."""

    phase: Callable[..., rt.Phase]
    costates: Callable[..., Any]

    def assert_three_arcs(self, solution: rt.Solution, top: float) -> None:
        """Three phases end at the junctions of Bryson-Denham's problem to 1e-6 s, and both costates are exact.

        At the junctions, where the costate of x jumps, every phase gives the limit from its side.
        """
        assert solution.objective == pytest.approx(4 / (9 * top), rel=1e-9)
        size = np.abs(self.costates(np.array([0.0]), top)[0])
        sides = [(0.0, 3 * top - 1e-9), (3 * top + 1e-9, 1 - 3 * top - 1e-9), (1 - 3 * top + 1e-9, 1.0)]
        for part, side in zip(rt.indirect.costates(solution).phases, sides, strict=True):
            first, last = part.solution.t0, part.solution.t0 + part.solution.duration
            assert (first, last) == pytest.approx(side, abs=1e-6)
            t = np.linspace(first, last, 401)
            exact = self.costates(np.clip(t, *side), top)
            assert part.duals.costate(t) / size == pytest.approx(exact / size, abs=1e-4)


def half_square(point: Any) -> Any:
    return 0.5 * point.u["u"] ** 2


@pytest.fixture(scope="session")
def kirk() -> Known:
    """Kirk's example 5.1-1: xdd = -xd + u, least effort, (0, 0) to (5, 2) in 2 s.

    lambda_x is a constant c2 and lambda_v = c2 + (c3 - c2) e^t; x and v are linear in (c2, c3), which the end fixes.
    """
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], -point.x["v"] + point.u["u"]])

    def phase(start: Any = (0.0, 0.0), **more: Any) -> rt.Phase:
        return rt.Phase(
            system,
            2.0,
            rt.State(list(start)),
            rt.State([5, 2]),
            rt.Lagrange(half_square),
            controls={"u": rt.between(-50, 50)},
            **more,
        )

    grown, decayed = np.exp(2.0) / 2, np.exp(-2.0) / 2
    ends = [[-2 - decayed + grown, 1 - decayed - grown], [-1 + decayed + grown, decayed - grown]]
    c2, c3 = np.linalg.solve(ends, [5, 2])

    def costates(t: Any) -> Any:
        return np.column_stack([np.full(len(t), c2), c2 + (c3 - c2) * np.exp(t)])

    return Known(phase, costates)


@pytest.fixture(scope="session")
def bryson_denham() -> Known:
    """Double integrator from v = 1 back to v = -1 in 1 s below x = top = 1/9: three arcs, cut at 3 top and 1 - 3 top.

    Before the contact u = -2 / (3 top) (1 - t / (3 top)) = -lambda_v and lambda_x = 2 / (9 top^2); on the arc both
    vanish; then the mirror image. Other tops, up to 1/6, have the same three arcs.
    """
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])

    def phase(start: Any = (0.0, 1.0), as_path: bool = False, top: float = 1 / 9) -> rt.Phase:
        path = [rt.PathConstraint(lambda point: point.x["x"], upper=top)]
        return rt.Phase(
            system,
            1.0,
            rt.State(list(start)),
            rt.State([0, -1]),
            rt.Lagrange(half_square),
            constraints=path if as_path else [],
            states={} if as_path else {"x": rt.between(None, top)},
        )

    def costates(t: Any, top: float = 1 / 9) -> Any:
        reach = 3 * top
        away = np.minimum(t, 1 - t)
        by_v = np.where(away < reach, 2 / reach * (1 - away / reach), 0.0)
        by_x = 2 / reach**2 * np.where(t < reach, 1.0, np.where(t < 1 - reach - 1e-12, 0.0, -1.0))
        return np.column_stack([by_x, by_v])

    return Known(phase, costates)


@pytest.fixture(scope="session")
def block() -> Callable[..., rt.Phase]:
    """1 kg, 1 N, 10 m, in minimum time: 2 sqrt(10) s, one switch half-way."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])

    def phase(start: Any = (0.0, 0.0)) -> rt.Phase:
        return rt.Phase(
            system,
            (0.1, 20),
            rt.State(list(start)),
            rt.State([10, 0]),
            rt.Duration(),
            controls={"u": rt.between(-1, 1)},
        )

    return phase


@pytest.fixture(scope="session")
def swing_up() -> Callable[..., rt.Phase]:
    """Kelly's cart-pole swing-up of a robot, least effort in 2 s."""
    robot = rt.load("cartpole")

    def phase(start: Any = (0.0, 0.0), force: float = 20.0, **more: Any) -> rt.Phase:
        limits = robot.limits.with_(effort=force)
        return rt.Phase(
            robot, 2.0, rt.State(q=list(start), v=0), rt.State(q=[1, np.pi], v=0), rt.Effort(), limits=limits, **more
        )

    return phase


@pytest.fixture(scope="session")
def algebraic() -> Callable[..., rt.Phase]:
    """An index-1 DAE, w + 0.1 w^3 = u, xdot = w - x, with a Mayer term on the free end."""
    system = rt.System(
        ["x"],
        ["u"],
        lambda point: [point.z["w"] - point.x["x"]],
        algebraic=["w"],
        residual=lambda point: [point.z["w"] + 0.1 * point.z["w"] ** 3 - point.u["u"]],
    )

    def phase(start: float = 1.0) -> rt.Phase:
        cost = rt.Lagrange(lambda point: point.u["u"] ** 2) + 5 * rt.Mayer(lambda a, b: (b.x["x"] - 2) ** 2)
        return rt.Phase(system, 1.0, rt.State([start]), objective=cost)

    return phase
