"""A sliding mass planned in one to four phases has one optimum; a bouncing mass jumps between two phases."""

import robotraj as rt

slider = rt.System(states=["x", "v"], controls=["F"], dynamics=lambda point: [point.x["v"], point.u["F"]])
force = {"F": rt.between(-20, 20)}
mesh = rt.schemes.MovingMesh(4, rt.schemes.RadauIIA(3, control=rt.schemes.ConstantControl()))

for count in (1, 2, 3, 4):
    ends = [rt.State([0, 0]), *(rt.State({"x": k / count}) for k in range(1, count)), rt.State([1, 0])]
    phases = [
        rt.Phase(slider, (0.001, 1.0), start, end, rt.Duration(), controls=force, name=f"part of {count}")
        for start, end in zip(ends[:-1], ends[1:], strict=True)
    ]
    problem = rt.Problem(phases, [rt.Continuity(k, k + 1) for k in range(count - 1)])
    solution = rt.plan(problem, mesh=mesh, solver=rt.Ipopt(tolerance=1e-11))
    print(f"{count} phases: {solution.duration:.9f} s, exactly 0.447213595")

# The mass hits a wall at x = 0.5 m with at least 1 m/s and rebounds with 80 % of its speed.
wall = rt.State({"x": 0.5, "v": rt.between(1, None)})
to, back = (
    rt.Phase(slider, (0.01, 2.0), start, end, rt.Effort(), controls=force, name=name)
    for name, start, end in (
        ("to the wall", rt.State([0, 0]), wall),
        ("and back", rt.State({"x": 0.5}), rt.State([0, 0])),
    )
)
bounce = rt.links.Linkage((0, 1), lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"], name="restitution", unit="m/s")
problem = rt.Problem([to, back], [rt.links.Jump(0, 1, jumps={"v": None}), bounce])
solution = rt.plan(problem, mesh=rt.Mesh(20))
print(solution)

report = rt.validate(solution)
print(report)
report.check(drift=1e-6, limits=1e-3)
print("wrote", rt.replay(solution, "07_phases.html", report=report))
