"""A damped pendulum swings up with least effort, and then with a motor too weak to lift it."""

import numpy as np

import robotraj as rt

pendulum = rt.load("pendulum")
swing_up = rt.Phase(
    pendulum,
    duration=(0.5, 2.5),
    start=rt.State(q=0, v=0),
    end=rt.State(q=np.pi, v=0),
    objective=rt.Effort(),
    name="pendulum swing-up",
)
solution = rt.plan(swing_up, mesh=rt.Mesh(20, rt.HermiteSimpson()))
print(solution)

# Gravity exerts up to 1 N m. A motor of 0.5 N m has to swing the pendulum back and forth.
weak = rt.Phase(
    pendulum,
    duration=(2.0, 20.0),
    start=rt.State(q=0, v=0),
    end=rt.State(q=np.pi, v=0),
    objective=rt.Duration() + 0.1 * rt.Effort(),
    limits=pendulum.limits.with_(effort=0.5),
    name="pendulum with a weak motor",
)
solution = rt.plan(weak, mesh=rt.Mesh(80, rt.HermiteSimpson(control=rt.schemes.LinearControl())))
print(solution)
report = rt.validate(solution)
print(report)
report.check(drift=1e-3, limits=1e-3)
print("wrote", rt.replay(solution, "02_pendulum.html", report=report))
