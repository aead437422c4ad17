"""T1 with robotraj; a bang-bang force is constant within each interval, so it cannot bulge over its limit."""

from plan_robotraj import finish
from report import asked

import robotraj as rt

task = asked("T1")
phase = rt.Phase(
    rt.load("block"),
    duration=task.duration,
    start=rt.State(q=task.start, v=0),
    end=rt.State(q=task.end, v=0),
    objective=rt.Duration(),
)
mesh = rt.Mesh(task.intervals, rt.HermiteSimpson(control=rt.ConstantControl()))
finish(rt.plan(phase, mesh, rt.StraightLine(task.guess), check=False, progress=False))
