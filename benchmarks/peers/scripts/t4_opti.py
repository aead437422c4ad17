"""T4 by hand: forward dynamics of the ur5's URDF (Pinocchio's ABA as a CasADi graph)."""

import casadi as ca
import pinocchio as pin
from hermite_simpson import solve
from report import asked, urdf

from robotraj.symbolic import SymbolicModel

task = asked("T4")
model = pin.buildModelFromUrdf(urdf(task))
aba = SymbolicModel(model).forward_dynamics
no_forces = ca.DM.zeros(6, model.njoints)
solve(task, lambda q, v, u: aba(q, v, u - ca.DM(model.damping) * v, no_forces))
