"""A humanoid with arms, 29 joints, stands up and takes a stride: both plans are proved, from the built-in guess."""

from functools import partial

import robotraj as rt

robot = rt.load("g1", root="floating")
feet = ("left_ankle_roll_link", "right_ankle_roll_link")
sole = partial(rt.FlatFoot, length=0.15, width=0.05, offset=(0.03, 0, -0.03))

# Heights of the centre of mass above the ground [m].
crouched, upright = (rt.gait.stand(robot, feet, sole, height=height) for height in (0.55, 0.64))
stand_up = rt.Phase(
    robot,
    duration=1.2,
    start=rt.State(q=crouched, v=0),
    end=rt.State(q=upright, v=0),
    objective=rt.gait.gait_objective(robot, upright),
    contacts=[sole(foot) for foot in feet],
    name="stand up",
)
# Left and right of the robot differ in inertia, so both steps are planned.
stride = rt.gait.walk(
    robot, feet=feet, contact=sole, duration=0.42, speed=0.26, double_support=0.2, clearance=0.04, repeat=rt.Periodic()
)

for name, motion in (("stand_up", stand_up), ("stride", stride)):
    solution = rt.plan(motion)
    print(solution)
    print(report := rt.validate(solution))
    report.check()
    print("wrote", rt.replay(solution, f"21_{name}.html", report=report))
