"""A block of 1 kg moves 10 m in minimum time with a force of at most 1 N: full acceleration, then full braking."""

import numpy as np

import robotraj as rt

block = rt.load("block")
move = rt.Phase(
    block,
    duration=(0.1, 200.0),
    start=rt.State(q=0, v=0),
    end=rt.State(q=10, v=0),
    objective=rt.Duration(),
    name="block, minimum time",
)
print(move)

# A force that is constant in every interval switches at the knots and keeps its limit between them.
mesh = rt.Mesh(50, rt.HermiteSimpson(control=rt.schemes.ConstantControl()))
solution = rt.plan(move, mesh=mesh)
print(solution)
print(f"minimum time {solution.duration:.7f} s, exactly 2 sqrt(10) = {2 * np.sqrt(10):.7f} s")

# rt.System takes any equations written with CasADi.
system = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
same = rt.Phase(
    system,
    duration=(0.1, 200.0),
    start=rt.State({"x": 0, "v": 0}),
    end=rt.State({"x": 10, "v": 0}),
    controls={"u": rt.between(-1, 1)},
    objective=rt.Duration(),
)
print(f"as two lines of CasADi: {rt.plan(same, mesh=mesh).duration:.7f} s")

report = rt.validate(solution)
print(report)
report.check(drift=1e-6, limits=1e-6)
print("wrote", rt.replay(solution, "01_block.html", report=report))
