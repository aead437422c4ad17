"""A ur5 moves within all limits of its URDF, with its wrist at least 5 cm above the ground."""

import robotraj as rt

ur5 = rt.load("ur5")
move = rt.Phase(
    ur5,
    duration=1.0,
    start=rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0),
    end=rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0),
    objective=rt.Effort(),
    constraints=[rt.GroundClearance(["forearm_link", "wrist_1_link", "tool0"], 0.05)],
    name="ur5, pick to place in 1 s",
)
print(move)

solution = rt.plan(move, mesh=rt.Mesh(50, rt.HermiteSimpson()))
print(solution, {stage: round(seconds, 2) for stage, seconds in solution.times.items()})

report = rt.validate(solution)
print(report)
report.check(drift=1e-3, limits=1e-3)
solution.plot().savefig("05_ur5.png")
print("wrote", rt.replay(solution, "05_ur5.html", traces=["tool0"], report=report))
