"""An acrobot with a motor at the elbow alone swings up; keyframes guide the solver to one of several optima."""

import numpy as np

import robotraj as rt

acrobot = rt.load("acrobot")
swing_up = rt.Phase(
    acrobot,
    duration=2.0,
    start=rt.State(q=[0, 0], v=0),
    end=rt.State(q=[np.pi, 0], v=0),
    objective=rt.Effort(),
    name="acrobot swing-up",
)
# Swing back, tuck, swing through, stand. The shoulder is measured from hanging, the elbow from the upper link.
poses = [[0, 0], [-np.pi / 2, np.pi / 2], [np.pi / 2, np.pi / 2], [np.pi, 0]]
keyframes = rt.guess.Keyframes([0, 0.25, 0.75, 1], [rt.State(q=pose, v=0) for pose in poses])

coarse = rt.plan(swing_up, mesh=rt.Mesh(20), guess=keyframes)
# Upright is unstable, so that small errors grow fast: refine until the error between the knots is below 1e-6.
solution = rt.plan(swing_up, mesh=rt.Mesh(40, rt.schemes.FifthDegree()), guess=coarse, tolerance=1e-6)
print(solution)

report = rt.validate(solution)
print(report)
report.check(drift=1e-2)
solution.save("04_acrobot.npz")
print("wrote", rt.replay(solution, "04_acrobot.html", report=report))
