"""A five-link biped climbs two stairs, from rest on both feet at the bottom to rest on both feet at the top."""

from dataclasses import replace

import robotraj as rt

robot = rt.load("five_link", root="planar")
stairs = rt.terrain.Steps.stairs(start=0.2, run=0.4, rise=0.1, count=2)
foot = rt.PointContact("left_foot", friction=0.8, ground=stairs)
left, right = "left_foot", "right_foot"
first, second = rt.between(0.25, 0.5), rt.between(0.65, 1.0)

# Standing feet, duration [s] and bounds of the footholds, which are unknowns away from the edges of the treads.
timetable = [
    ("lean forward", (left, right), 0.3, {}),
    ("right foot to the first stair", (left,), (0.4, 0.7), {}),
    ("left foot to the second", (right,), (0.4, 0.7), {"right_foot.x": first}),
    ("right foot beside it", (left,), (0.4, 0.7), {"left_foot.x": second}),
    ("come to rest", (left, right), 0.3, {"left_foot.x": second, "right_foot.x": second}),
]
supports = [rt.gait.Support(feet, duration, name) for name, feet, duration, _ in timetable]
terms = rt.gait.GaitTerms(foot, clearance=0.0, objective=rt.Effort(), ground=stairs)
start, end = rt.State(q=rt.gait.stand(robot), v=0), rt.State(v=0)
written = rt.gait.sequence(robot, supports, terms, None, start, end)
places = [where for *_, where in timetable]
phases = [replace(phase, parameters=where) for phase, where in zip(written.phases, places, strict=True)]
climb = rt.Problem(phases, written.links)

coarse = rt.plan(climb, rt.Mesh(6))
solution = rt.plan(climb, rt.Mesh(12, rt.schemes.LobattoIIIA(5)), guess=coarse)
print(solution)
print("footholds:", *(f"{k} = {v:.3f} m" for phase in solution.phases for k, v in phase.parameters.items()))
# Standing on points is unstable. Each phase is simulated open loop, and the whole climb with joint feedback.
report = rt.validate(solution, drift=None)
print(report)
report.check()
print(rt.witness.track(solution, kp=400.0, kd=40.0))
print("wrote", rt.replay(solution, "16_stairs.html", report=report))
