"""A panda moves its hand from one shelf to the next in minimum time: out, around the board between, and in again."""

import numpy as np
import pinocchio as pin

import robotraj as rt

panda = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
heights = {"bottom": 0.2, "middle": 0.55, "top": 0.9}
boards = [
    rt.obstacles.Box((0.3, 0.9, 0.03), position=(0.7, 0.0, z), name=f"{name} board") for name, z in heights.items()
]

# The hand points into the shelves, its axis z along world x.
ahead = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
lower, upper = pin.SE3(ahead, np.array([0.52, 0.2, 0.38])), pin.SE3(ahead, np.array([0.52, -0.2, 0.74]))
move = rt.Phase(
    panda,
    duration=(0.2, 5.0),
    start=rt.State(v=0),
    end=rt.State(v=0),
    objective=rt.Duration(),
    constraints=[
        rt.AtStart(rt.FramePose("panda_hand", lower)),
        rt.AtEnd(rt.FramePose("panda_hand", upper)),
        rt.CollisionFree(boards, margin=0.01),
    ],
    name="shelf to shelf",
)
solution = rt.plan(move)
print(solution)
report = rt.validate(solution)
print(report)
report.check()
print("wrote", rt.replay(solution, "24_shelf_to_shelf.html", traces=["panda_hand"], report=report))
