"""The algorithms of rigid bodies as CasADi functions, for any ``pinocchio.Model``.

The room replaces ``pinocchio.casadi``, which Pinocchio's wheels lack. It can be used without the rest of robotraj.
Start with ``model.py``. The room may import ``_util``.

>>> import pinocchio, robotraj.symbolic
>>> symbolic = robotraj.symbolic.SymbolicModel(pinocchio.buildSampleModelManipulator())
>>> symbolic.inverse_dynamics
Function(inverse_dynamics:(q[6],v[6],a[6],fext[6x7])->(tau[6]) SXFunction)
"""

from robotraj.symbolic.model import SymbolicModel

__all__ = ["SymbolicModel"]
