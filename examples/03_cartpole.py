"""The cart-pole swing-up of Kelly's tutorial (SIAM Review 59, 2017), by four schemes."""

import numpy as np

import robotraj as rt

cartpole = rt.load("cartpole")
swing_up = rt.Phase(
    cartpole,
    duration=2.0,
    start=rt.State(q=[0, 0], v=0),
    end=rt.State(q=[1, np.pi], v=0),
    objective=rt.Effort(),
    name="cart-pole swing-up",
)

lecture = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
for scheme in (rt.schemes.Trapezoidal(), lecture, rt.HermiteSimpson(), rt.schemes.FifthDegree()):
    solution = rt.plan(swing_up, mesh=rt.Mesh(40, scheme))
    print(f"{scheme}: {solution.objective:.6f} (exact 58.807667)")

report = rt.validate(solution)
print(report)
report.check(drift=1e-4)
solution.plot().savefig("03_cartpole.png")
print("wrote", rt.replay(solution, "03_cartpole.html", report=report))
