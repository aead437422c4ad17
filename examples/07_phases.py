"""A sliding mass in one to four phases gives one answer; a bouncing one jumps between two."""

import robotraj as rt

slider = rt.System(states=["x", "v"], controls=["F"], dynamics=lambda point: [point.x["v"], point.u["F"]])
mesh = rt.MovingMesh(4, rt.RadauIIA(3, control=rt.ConstantControl()))


def part(k: int, count: int) -> rt.Phase:
    """Build phase k of count, which covers x from k / count to (k + 1) / count."""
    return rt.Phase(
        slider,
        duration=(0.001, 1.0),
        start=rt.State([0, 0]) if k == 0 else None,
        end=rt.State([1, 0]) if k == count - 1 else rt.State({"x": (k + 1) / count}),
        controls={"F": rt.between(-20, 20)},
        objective=rt.Duration(),
        name=f"part {k + 1} of {count}",
    )


for count in (1, 2, 3, 4):
    links = [rt.Continuity(k, k + 1) for k in range(count - 1)]
    problem = rt.Problem([part(k, count) for k in range(count)], links)
    solution = rt.plan(problem, mesh=mesh, solver=rt.Ipopt(tolerance=1e-11))
    print(f"{count} phases: {solution.duration:.9f} s, exactly 0.447213595")

# The mass hits a wall at x = 0.5 with at least 1 m/s and comes back with 80 % of its speed.
hit = {"start": rt.State([0, 0]), "end": rt.State({"x": 0.5, "v": rt.between(1, None)})}
back = {"start": rt.State({"x": 0.5}), "end": rt.State([0, 0])}
phases = [
    rt.Phase(slider, duration=(0.01, 2.0), controls={"F": rt.between(-20, 20)}, objective=rt.Effort(), name=name, **ends)
    for name, ends in (("to the wall", hit), ("and back", back))
]
bounce = rt.Linkage((0, 1), lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"], name="restitution", unit="m/s")
position = rt.Jump(0, 1, jumps={"v": None})
solution = rt.plan(rt.Problem(phases, [position, bounce]), mesh=rt.Mesh(20))
print(solution)
report = rt.validate(solution)
print(report)
report.check(drift=1e-6, limits=1e-3)
print("wrote", rt.replay(solution, "07_phases.html"))
