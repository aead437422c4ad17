"""T5 with robotraj."""

from plan_robotraj import finish
from report import asked

import robotraj as rt

task = asked("T5")
phase = rt.Phase(
    rt.load("panda"),
    duration=task.duration,
    start=rt.State(q=task.start, v=0),
    end=rt.State(q=task.end, v=0),
    objective=rt.Duration(),
)
finish(rt.plan(phase, rt.Mesh(task.intervals), rt.StraightLine(task.guess), check=False, progress=False))
