"""A study of a block that moves in a given time: the effort is 12 / T^3 [N^2 s]."""

from __future__ import annotations

import robotraj as rt
from robotraj.applications.studies.cases import Case

OPTIONS = {"mesh": rt.Mesh(4)}


def make(case: Case) -> rt.Phase:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    bound = float(case.get("bound", 1e3))
    return rt.Phase(
        block,
        duration=float(case["T"]),
        start=rt.State([0, 0]),
        end=rt.State([1, 0]),
        controls={"u": rt.between(-bound, bound)},
        objective=rt.Lagrange(lambda point: point.u["u"] ** 2),
    )


def cases(count: int) -> list[dict[str, float]]:
    return [{"T": 1.0 + 0.1 * i} for i in range(count)]
