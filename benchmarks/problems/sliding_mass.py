"""A unit mass from 0 to 1 in minimum time under a force of at most 20 N, in phases of equal distance."""

from __future__ import annotations

from math import sqrt

import robotraj as rt

from .case import Case

SLIDER = rt.System(
    ["x", "v"], ["F"], lambda point: [point.x["v"], point.u["F"]], units={"x": "m", "v": "m/s", "F": "N"}
)


def sliding_mass(count: int) -> Case:
    """Phase k of count covers x from k / count to (k + 1) / count; time and speed run on."""

    def phase(k: int) -> rt.Phase:
        return rt.Phase(
            SLIDER,
            (1e-3, 1.0),
            rt.State([0, 0]) if k == 0 else rt.State({"x": k / count}),
            rt.State([1, 0]) if k == count - 1 else rt.State({"x": (k + 1) / count}),
            rt.Duration(),
            states={"x": rt.between(0, 1), "v": rt.between(0, 10)},
            controls={"F": rt.between(-20, 20)},
            name=f"part {k + 1} of {count}",
        )

    problem = rt.Problem([phase(k) for k in range(count)], [rt.Continuity(k, k + 1) for k in range(count - 1)])
    name = f"sliding mass, {count} phase{'s' if count > 1 else ''}"
    return Case(name, problem, rt.guess.StraightLine(), 2 / sqrt(20), 0.0, "closed form: 2 / sqrt(20)")
