"""A five-link biped runs at 2.5 m/s: stance, flight, and a landing on the other foot."""

from dataclasses import replace

import numpy as np

import robotraj as rt

robot = rt.load("five_link", root="planar")
written = rt.gait.run(robot, step_length=1.0, duration=0.4, contact=rt.PointContact("left_foot", friction=0.8))
# The durations of stance and flight are free; their sum is given.
stance, flight = (replace(phase, duration=(0.05, 0.35)) for phase in written.phases)
pace = rt.links.Linkage(
    [0, 1], lambda first, last: last.end.t - first.start.t, 0.4, 0.4, name="time of a step", unit="s"
)
problem = rt.Problem([stance, flight], [*written.links, pace])
# Torques that are linear in every interval keep their limits between the knots.
solution = rt.plan(problem, mesh=rt.Mesh(10, rt.HermiteSimpson(control=rt.schemes.LinearControl())), tolerance=1e-5)
print(solution)
report = rt.validate(solution)
print(report)
report.check(drift=1e-3)

stood, flown = (phase.duration for phase in solution.phases)
push = solution.at(np.linspace(0, stood, 200)).forces["left_foot"][:, 2].max()
print(f"stance {stood:.3f} s, flight {flown:.3f} s, the ground pushes with up to {push:.0f} N")
times = np.linspace(0, solution.duration, 2001)
sample = solution.at(times)
work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 3:], 0).sum(axis=1), times)
print(f"cost of transport {work / (40 * 9.81 * 1.0):.3f}: positive work by weight and distance")
print("wrote", rt.replay(solution, "12_five_link_running.html", periods=6, report=report))
