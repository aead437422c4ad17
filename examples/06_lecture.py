"""The lecture's experiment: a block moved 10 m in minimum time by every method, with its figures drawn anew."""

import time

import numpy as np
from matplotlib.figure import Figure

import robotraj as rt

block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
lecture = rt.HermiteSimpson(control=rt.LinearControl(), quadrature=rt.TrapezoidalQuadrature())


def move(brake: float = 1.0) -> rt.Phase:
    """Full ahead, full back; the switch is at the fraction brake / (1 + brake) of the duration."""
    ends = rt.State([0, 0]), rt.State([10, 0])
    return rt.Phase(block, (0.1, 200.0), *ends, rt.Duration(), controls={"u": rt.between(-brake, 1)}, name="block")


def timed(phase: rt.Phase, mesh: rt.Mesh) -> tuple[rt.Solution, float]:
    """Plan; return the solution and the seconds it took."""
    began = time.perf_counter()
    return rt.plan(phase, mesh), time.perf_counter() - began


# Direct collocation, multiple and single shooting.
exact = 2 * np.sqrt(10)
methods = {
    "collocation, 51 points": rt.Mesh(50, lecture),
    "collocation, 101 points": rt.Mesh(100, lecture),
    "collocation, 201 points": rt.Mesh(200, lecture),
    "multiple shooting, 21 points": rt.Mesh(20, rt.MultipleShooting()),
    "single shooting, 21 points": rt.Mesh(20, rt.SingleShooting()),
}
print(f"{'method':30} {'duration [s]':>12} {'error [s]':>10} {'iterations':>10} {'seconds':>8}")
solutions = {}
for name, mesh in methods.items():
    solution, seconds = timed(move(), mesh)
    solutions[name] = solution
    error = solution.duration - exact
    print(f"{name:30} {solution.duration:12.7f} {error:10.1e} {solution.iterations:10d} {seconds:8.3f}")

figure = Figure(figsize=(15, 7), layout="constrained")
for column, (name, solution) in zip(figure.subplots(3, 5, sharex=True, sharey="row").T, solutions.items(), strict=True):
    part = solution.phases[0]
    for axes, symbol in zip(column, ("x", "v", "u"), strict=True):
        for k, (first, last) in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):
            t = np.linspace(first, last, 5)
            sample = part.at(t, interval=k)
            values = sample.u[symbol] if symbol == "u" else sample.x[symbol]
            axes.plot(t, values, "C0")
            axes.plot(t[[0, -1]], values[[0, -1]], "C1.", markersize=3)
        axes.grid(alpha=0.3)
    column[0].set_title(name)
    column[-1].set_xlabel("t [s]")
for axes, label in zip(figure.axes[::5], ("x [m]", "v [m/s]", "u [N]"), strict=True):
    axes.set_ylabel(label)
figure.savefig("06_solutions.png", dpi=100)

# Error and seconds against the number of points, with a switch that is at no knot.
brake = 2.0
exact = np.sqrt(20 * (1 + 1 / brake))
schemes = {
    "trapezoid": rt.Trapezoidal(),
    "lecture's scheme": lecture,
    "Hermite-Simpson, free mid-point": rt.HermiteSimpson(),
    "Radau IIA, 3 points": rt.RadauIIA(3),
    "multiple shooting": rt.MultipleShooting(),
}
figure = Figure(figsize=(13, 5), layout="constrained")
left, right = figure.subplots(1, 2)
for name, scheme in schemes.items():
    runs = [timed(move(brake), rt.Mesh(n, scheme)) for n in (10, 20, 50, 100, 200)]
    points = [len(solution.phases[0].points) for solution, _ in runs]
    left.loglog(points, [abs(solution.duration - exact) for solution, _ in runs], "o-", label=name)
    right.loglog(points, [seconds for _, seconds in runs], "o-", label=name)

# An adaptive mesh: few intervals first, then small ones around the switch.
adaptive = rt.plan(move(brake), rt.Mesh(10, rt.RadauIIA(3)), tolerance=1e-6)
print(adaptive)
steps = adaptive.refinement
left.loglog([s.points for s in steps], [abs(s.objective - exact) for s in steps], "k*-", label="adaptive, Radau IIA")
right.loglog([s.points for s in steps], np.cumsum([s.seconds for s in steps]), "k*-", label="adaptive, Radau IIA")
left.set(xlabel="points", ylabel="error of the duration [s]", title=f"-{brake:g} <= u <= 1, exactly {exact:.6f} s")
right.set(xlabel="points", ylabel="seconds", title="seconds, all meshes of the adaptive run added up")
for axes in (left, right):
    axes.grid(alpha=0.3, which="both")
    axes.legend()
figure.savefig("06_cost.png", dpi=100)

figure = Figure(figsize=(13, 6), layout="constrained")
over, under = figure.subplots(2, 1, sharex=True)
knots = adaptive.phases[0].knots
times = np.linspace(0, adaptive.duration, 2001)
over.plot(times, adaptive.at(times).u["u"], label="control [N]")
over.plot(knots, adaptive.at(knots).x["v"], "C1.-", label="velocity at knots [m/s]")
over.legend()
under.stairs(np.diff(knots), knots, baseline=None)
under.plot(knots, np.full(len(knots), np.diff(knots).min() / 2), "k|")
under.set(xlabel="t [s]", ylabel="length of interval [s]", yscale="log", title=f"{len(knots) - 1} intervals")
figure.savefig("06_mesh.png", dpi=100)
print("wrote 06_solutions.png, 06_cost.png and 06_mesh.png")
