"""A ur5 picks up a load, carries it past a post and puts it down: three phases, one plan in minimum time."""

import robotraj as rt

ur5 = rt.load("ur5")
load = rt.robot.CarriedBody("tool0", mass=2.0, center_of_mass=(0, 0, 0.06), inertia=(0.004, 0.004, 0.004))
post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
carried = rt.obstacles.Box((0.08, 0.08, 0.08), position=(0, 0, 0.06), frame="tool0", name="load")

rest = rt.State(q=[-1.6, -1.6, 1.2, -1.2, -1.57, 0.0], v=0)
pick = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0)
place = rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
clear = rt.CollisionFree([post], margin=0.01, self_collision=False)
loaded = rt.CollisionFree([post, carried], margin=0.01, self_collision=False)

# The load is part of the robot in the second phase only: it is attached and released at the ends of that phase.
reach = rt.Phase(ur5, (0.1, 5), rest, pick, rt.Duration(), [clear], name="reach")
carry = rt.Phase(rt.robot.carrying(ur5, load), (0.1, 5), pick, place, rt.Duration(), [loaded], name="carry")
retreat = rt.Phase(ur5, (0.1, 5), place, rest, rt.Duration(), [clear], name="return")
work = rt.Problem([reach, carry, retreat], [rt.Continuity(0, 1), rt.Continuity(1, 2)])

solution = rt.plan(work)
print(solution)
print(*(f"{phase.phase.name}: {phase.duration:.2f} s" for phase in solution.phases), sep="\n")
report = rt.validate(solution)
print(report)
report.check()
print("wrote", rt.replay(solution, "23_pick_and_place.html", traces=["tool0"], report=report))
