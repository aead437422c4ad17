"""A ur5 passes a post in minimum time: its distance is proved between the points, and checked by coal."""

import robotraj as rt

ur5 = rt.load("ur5")
post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
around = rt.Phase(
    ur5,
    duration=(0.2, 5.0),
    start=rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0),
    end=rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0),
    objective=rt.Duration(),
    constraints=[rt.CollisionFree([post], margin=0.01, self_collision=False)],
    name="ur5 around a post",
)
solution = rt.plan(around)
print(solution)
print(solution.proof)

report = rt.validate(solution)
print(report)
report.check()
print("wrote", rt.replay(solution, "20_around_a_box.html", traces=["tool0"], report=report))
