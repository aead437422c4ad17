"""A ur5 carries a glass of water: its axis stays within 1 degree of the vertical, in the plan and in MuJoCo."""

import numpy as np
import pinocchio as pin

import robotraj as rt

ur5 = rt.load("ur5")
home = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
data, tool = ur5.model.createData(), ur5.frame("tool0")
pin.framesForwardKinematics(ur5.model, data, home)
first = pin.SE3(data.oMf[tool])
up = first.rotation.T @ [0, 0, 1]

# The plan leaves half of the degree, and most of the torque, to the controller.
upright = rt.constraints.FrameAxis("tool0", axis=up, angle=np.deg2rad(0.5))
table = rt.AtEnd(rt.FramePosition("tool0", first.translation + [-0.1, 0.45, 0.1]))
ends, gentle = (rt.State(q=home, v=0), rt.State(v=0)), ur5.limits.with_(velocity=1.5, acceleration=5.0)
carry = rt.Phase(ur5, (0.1, 5), *ends, rt.Duration(), [upright, table], limits=gentle, name="a glass of water")
solution = rt.plan(carry)
print(solution)
report = rt.validate(solution)
print(report)
report.check()


def tilt(q):
    """Angle between the glass and the vertical [degrees]."""
    pin.framesForwardKinematics(ur5.model, data, q)
    return np.degrees(np.arccos(np.clip((data.oMf[tool].rotation @ up)[2], -1, 1)))


planned = max(map(tilt, solution.at(np.linspace(0, solution.duration, 2001)).q))
carried = max(map(tilt, rt.witness.second_opinion(solution).simulation.q))
print(f"{solution.duration:.2f} s, tilted by {planned:.2f} degrees at most as planned, {carried:.2f} in MuJoCo")
print("wrote", rt.replay(solution, "25_glass_of_water.html", traces=["tool0"], report=report))
