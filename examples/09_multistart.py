"""Multistart lists the local optima; continuation and a sweep solve families of problems."""

import numpy as np

import robotraj as rt


def swing_up(target: float) -> rt.Phase:
    """Swing the cart-pole up while the cart ends at ``target`` [m]."""
    return rt.Phase(
        rt.load("cartpole"),
        duration=2.0,
        start=rt.State(q=[0, 0], v=0),
        end=rt.State(q=[target, np.pi], v=0),
        objective=rt.Effort(),
        name=f"cart-pole to {target:g} m",
    )


found = rt.multistart(swing_up(1.0), starts=20, seed=0, mesh=rt.Mesh(40))
print(found)

first = rt.planning.ContinuationStep(mesh=rt.Mesh(10), objective=rt.Effort() + rt.Duration())
print(rt.plan(swing_up(1.0), mesh=rt.Mesh(40), continuation=[first]))

targets = (0.5, 1.0, 1.5)
for x, solution in zip(targets, rt.sweep([swing_up(x) for x in targets], mesh=rt.Mesh(40)), strict=True):
    print(f"cart-pole to {x:g} m: {solution.objective:.3f} N^2 s, {solution.status.value}")

print("wrote", rt.replay(found.best, "09_multistart.html"))
