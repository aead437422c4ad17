"""The lecture's experiment: a block moves 10 m in minimum time with |u| <= 1, by six methods, with figures."""

import numpy as np
from matplotlib.figure import Figure

import robotraj as rt

block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
ends = rt.State([0, 0]), rt.State([10, 0])
move = rt.Phase(block, (0.1, 200.0), *ends, objective=rt.Duration(), controls={"u": rt.between(-1, 1)})
lecture = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
methods = {
    "collocation, 51 points": (rt.Mesh(50, lecture), None),
    "collocation, 101 points": (rt.Mesh(100, lecture), None),
    "collocation, 201 points": (rt.Mesh(200, lecture), None),
    "multiple shooting, 21 points": (rt.Mesh(20, rt.schemes.MultipleShooting()), None),
    "single shooting, 21 points": (rt.Mesh(20, rt.schemes.SingleShooting()), None),
    "adaptive mesh from 7 intervals": (rt.Mesh(7, rt.schemes.RadauIIA(3)), 1e-6),
}
print(f"exactly 2 sqrt(10) = {2 * np.sqrt(10):.7f} s")
plans = {name: rt.plan(move, mesh, tolerance=tolerance) for name, (mesh, tolerance) in methods.items()}
figure = Figure(figsize=(18, 7), layout="constrained")
for (name, solution), column in zip(plans.items(), figure.subplots(3, 6, sharex=True, sharey="row").T, strict=True):
    part, seconds = solution.phases[0], solution.seconds
    print(f"{name:30} {solution.duration:.7f} s, error {solution.duration - 2 * np.sqrt(10):.1e} s, in {seconds:.3f} s")
    for k, span in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):
        sample = part.at(np.linspace(*span, 5), interval=k)
        for axes, values in zip(column, (sample.x["x"], sample.x["v"], sample.u["u"]), strict=True):
            axes.plot(sample.t, values, "C0")
            axes.plot(sample.t[[0, -1]], values[[0, -1]], "C1.", markersize=3)
    column[0].set_title(name)
    column[2].set_xlabel("t [s]")
for axes, label in zip(figure.axes[::6], ("x [m]", "v [m/s]", "u [N]"), strict=True):
    axes.set_ylabel(label)
figure.savefig("06_lecture.png", dpi=100)
print("wrote 06_lecture.png")
print("wrote", rt.replay(plans["adaptive mesh from 7 intervals"], "06_lecture.html"))
