"""Two ur5 face each other and swap sides at once in least time, without touching each other or themselves."""

import numpy as np

import robotraj as rt

ur5 = rt.load("ur5")
pair = rt.robot.join({"left": ur5, "right": ur5}, at={"right": ((0.9, 0, 0), (0, 0, 1, 0))})

ahead = np.array([0.0, -1.2, 1.4, -1.7, -1.57, 0.0])
aside = np.array([1.2, 0.0, 0.0, 0.0, 0.0, 0.0])
swap = rt.Phase(
    pair,
    duration=(0.2, 10),
    start=rt.State(q=np.append(ahead + aside, ahead - aside), v=0),
    end=rt.State(q=np.append(ahead - aside, ahead + aside), v=0),
    objective=rt.Duration(),
    constraints=[rt.CollisionFree()],
    name="two arms swap sides",
)
solution = rt.plan(swap)
print(solution)
alone = rt.plan(swap.with_(constraints=[]))
print(f"{solution.duration:.3f} s; {alone.duration:.3f} s where they may pass through each other")

report = rt.validate(solution)
print(report)
report.check()
print("wrote", rt.replay(solution, "22_two_arms.html", traces=["left_tool0", "right_tool0"], report=report))
