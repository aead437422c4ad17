"""Time and memory that CasADi takes to differentiate a point function, announced to the limits of the plan.

CasADi cannot be interrupted. Its time is proportional to W, the operations of the function times its unknowns: each
operation is differentiated in each direction. Functions that a graph calls count once for every call.
"""

from __future__ import annotations

import casadi as ca

from robotraj._util.time_left import require
from robotraj._util.values import dataclass

MEGA = 1e6


@dataclass(frozen=True)
class Cost:
    """Cost of one derivative for every unit of W.

    Attributes
    ----------
    seconds : float
        Processor time [s].
    bytes : float
        Memory.
    """

    seconds: float
    bytes: float

    def announce(self, operations: int, unknowns: int) -> None:
        """Announce a derivative to the limits of the plan.

        Raises
        ------
        LimitReached
            The plan has less time or memory left.
        """
        work = float(operations) * unknowns
        require(self.seconds * work, self.bytes * work / MEGA)


JACOBIAN, HESSIAN = Cost(3e-7, 80.0), Cost(9e-7, 220.0)
"""Costs of scalar graphs; measured with one-step schemes for ur5 and panda."""
JACOBIAN_OF_CALLS, HESSIAN_OF_CALLS = Cost(6e-9, 1.0), Cost(4.5e-8, 3.0)
"""Costs of graphs that call functions, for which only the calls are written again; with the first evaluation."""
EVALUATIONS = 150
"""Evaluations of the equations of motion by an integrator with variable step over an interval; measured with ur5."""


def operations(function: ca.Function) -> int:
    """Return the number of operations of a function, with those of the functions that it calls."""
    if function.is_a("SXFunction"):
        return int(function.n_instructions())
    if function.class_name() == "CvodesInterface":
        return EVALUATIONS * operations(function.oracle())
    if not function.is_a("MXFunction"):
        return 1  # such as a table
    count = int(function.n_instructions())
    calls = [function.instruction_MX(k) for k in range(count) if function.instruction_id(k) == ca.OP_CALL]
    return count + sum(operations(call.which_function()) for call in calls)
