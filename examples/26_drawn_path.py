"""A ur5 draws an eight with its tool as fast as its motors allow: a given path of the joints, retimed."""

import numpy as np
import pinocchio as pin

import robotraj as rt

ur5 = rt.load("ur5")
home = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
data, tool = ur5.model.createData(), ur5.frame("tool0")
pin.framesForwardKinematics(ur5.model, data, home)
first = pin.SE3(data.oMf[tool])

# Inverse kinematics point by point: the tool keeps its attitude.
drawn, q = [], home
for s in np.linspace(0, 2 * np.pi, 41):
    target = pin.SE3(first.rotation, first.translation + [0.08 * np.sin(2 * s), 0.2 * np.sin(s), 0.0])
    for _ in range(10):
        pin.framesForwardKinematics(ur5.model, data, q)
        jacobian = pin.computeFrameJacobian(ur5.model, data, q, tool)
        q = q + np.linalg.solve(jacobian, pin.log(data.oMf[tool].actInv(target)).vector)
    drawn.append(q)

solution = rt.retime(drawn, ur5)
print(solution)
print(f"{solution.duration:.3f} s along the path")
report = rt.validate(solution)
print(report)
report.check()
print("wrote", rt.replay(solution, "26_drawn_path.html", traces=["tool0"], report=report))
