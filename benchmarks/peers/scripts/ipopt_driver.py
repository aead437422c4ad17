"""IPOPT for OpenMDAO by way of cyipopt: pyOptSparse, the usual interface, has no wheels."""

from __future__ import annotations

from typing import Any

import cyipopt
import numpy as np
from openmdao.core.driver import Driver, RecordingDebugging
from report import Clock


class IpoptDriver(Driver):
    """Evaluates the model at IPOPT's iterates; sparse Jacobian by OpenMDAO's total coloring.

    Attributes
    ----------
    clock : Clock
        Around IPOPT.
    status, message, iterations
        As reported by IPOPT.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__()
        self.settings = options
        for kind in ("optimization", "gradients", "inequality_constraints", "equality_constraints",
                     "two_sided_constraints", "simultaneous_derivatives"):  # fmt: skip
            self.supports._read_only = False
            self.supports[kind] = True
        self.supports._read_only = True
        self._total_jac_format = "array"
        self.clock, self.status, self.message, self.iterations = Clock(), -1, "", 0

    def _get_name(self) -> str:
        return "IPOPT"

    def _run_at(self, x: np.ndarray) -> None:
        """Run the model, unless it has just been run there."""
        if self._at is None or not np.array_equal(x, self._at):
            self._vectors["design_var"].set_data(x.copy(), driver_scaling=True)
            self._set_design_vars(driver_scaling=True)
            with RecordingDebugging("IPOPT", self.iter_count, self):
                self._run_solve_nonlinear()
            self.iter_count += 1
            self._at, self._slopes = x.copy(), None

    def _totals(self, x: np.ndarray) -> np.ndarray:
        self._run_at(x)
        if self._slopes is None:
            self._slopes = self._compute_totals(of=self._of, wrt=list(self._designvars), return_format="array")
        return self._slopes

    def objective(self, x: np.ndarray) -> float:
        """Objective for cyipopt, as are the four below."""
        self._run_at(x)
        return float(next(iter(self.get_objective_values().values()))[0])

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Gradient of the objective."""
        return self._totals(x)[0].copy()

    def constraints(self, x: np.ndarray) -> np.ndarray:
        """All constraints, one after the other."""
        self._run_at(x)
        values = self.get_constraint_values()
        return np.concatenate([np.ravel(values[name]) for name in self._cons])

    def jacobianstructure(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns that coloring found."""
        return self._structure

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Values at these places."""
        rows, columns = self._structure
        return self._totals(x)[rows + 1, columns]

    def intermediate(self, mode: int, iteration: int, *_: Any) -> bool:
        """Count."""
        self.iterations = iteration
        return True

    def run(self) -> bool:
        """Optimise; True where that failed."""
        self.result.reset()
        problem = self._problem()
        self.iter_count, self._at, self._slopes = 0, None, None
        self._of = [*self._objs, *self._cons]
        self._run_solve_nonlinear()
        coloring = problem.get_total_coloring(self._coloring_info, run_model=False)
        rows, columns = np.nonzero(coloring.get_dense_sparsity())
        self._structure = rows[rows > 0] - 1, columns[rows > 0]

        def sides(kind: str, metas: Any) -> tuple[np.ndarray, np.ndarray]:
            bounds = self._autoscaler.get_bounds_scaling(kind)
            low, high = [], []
            for name, meta in metas.items():
                size, bound = meta["size"], bounds[name]
                equal = getattr(bound, "equals", None)
                low.append(np.broadcast_to(_either(equal, bound.lower, -np.inf), size))
                high.append(np.broadcast_to(_either(equal, bound.upper, np.inf), size))
            return np.concatenate(low), np.concatenate(high)

        values = self.get_design_var_values()
        x0 = np.concatenate([np.ravel(values[name]) for name in self._designvars])
        (lb, ub), (cl, cu) = sides("design_var", self._designvars), sides("constraint", self._cons)
        ipopt = cyipopt.Problem(n=len(x0), m=len(cl), problem_obj=self, lb=lb, ub=ub, cl=cl, cu=cu)
        for name, value in self.settings.items():
            ipopt.add_option(name, value)
        with self.clock:
            x, info = ipopt.solve(x0)
        self._run_at(x)
        self.status, self.message = info["status"], info["status_msg"].decode()
        self.fail = self.status not in (0, 1)
        return self.fail


def _either(equal: Any, bound: Any, none: float) -> Any:
    return equal if equal is not None else bound if bound is not None else none
