"""A ur5 draws a straight line in minimum time with its tool pointing down: four equality constraints throughout."""

import numpy as np
import pinocchio as pin

import robotraj as rt

ur5 = rt.load("ur5")
line = rt.FramePosition("tool0", {"x": 0.45, "z": 0.1})
down = rt.PathConstraint(lambda point: point.frame("tool0").rotation[:2, 2], 0, 0, name="tool points down")
ends = [rt.AtStart(rt.FramePosition("tool0", {"y": 0.3})), rt.AtEnd(rt.FramePosition("tool0", {"y": -0.3}))]
draw = rt.Phase(
    ur5,
    duration=(0.2, 3.0),
    start=rt.State(v=0),
    end=rt.State(v=0),
    objective=rt.Duration(),
    constraints=[line, down, *ends],
    name="ur5, a line in least time",
)
about = [rt.State(q=[pan, -1.2, 1.6, -2.0, -1.57, 0.0]) for pan in (0.3, -0.8)]
everywhere = rt.interval_limits.BernsteinBounds(controls=True)
solution = rt.plan(draw, rt.Mesh(40), rt.guess.Keyframes([0, 1], about), interval_limits=everywhere)
print(solution)

# Distance of the tool from the line and from the vertical, at the points of the mesh and between them.
poses = []
for q in solution.at(np.linspace(0, solution.duration, 1001)).q:
    data = ur5.model.createData()
    pin.framesForwardKinematics(ur5.model, data, q)
    poses.append(data.oMf[ur5.frame("tool0")])
off = max(np.hypot(pose.translation[0] - 0.45, pose.translation[2] - 0.1) for pose in poses)
tilt = max(np.hypot(*pose.rotation[:2, 2]) for pose in poses)
print(f"off the line by {1e6 * off:.1f} um at most, tilted by {1e6 * tilt:.1f} urad")

report = rt.validate(solution)
print(report)
report.check(drift=1e-3, limits=1e-3)
print("wrote", rt.replay(solution, "18_tool_on_a_line.html", traces=["tool0"], report=report))
