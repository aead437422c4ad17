"""IPOPT, through CasADi, with exact derivatives assembled by the transcription.

Source: Waechter and Biegler, Mathematical Programming 106 (2006).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from re import sub

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.precision import ROUND_OFF
from robotraj._util.time_left import used_time
from robotraj._util.values import dataclass
from robotraj.solvers.base import (
    BARRIER,
    BOUND_RELAXATION,
    MOST_ITERATIONS,
    NEARBY_BARRIER,
    TOLERANCE,
    LazyMultipliers,
    Multipliers,
    Origin,
    Outcome,
    Progress,
    Solver,
)
from robotraj.solvers.checks import LOOSEST, above_zero, counted, named_options, no_mapping
from robotraj.solvers.ipopt_callback import IterationCallback
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

PUSHES = ("warm_start_bound_push", "warm_start_mult_bound_push", "warm_start_slack_bound_push")
"""Options that move a known solution away from its bounds."""
STATUSES = {
    "Solve_Succeeded": Status.SOLVED,
    "Solved_To_Acceptable_Level": Status.SOLVED,
    "Feasible_Point_Found": Status.SOLVED,
    "Infeasible_Problem_Detected": Status.INFEASIBLE,
    "Maximum_Iterations_Exceeded": Status.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": Status.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": Status.TIME_LIMIT,
    "User_Requested_Stop": Status.INTERRUPTED,
    "Search_Direction_Becomes_Too_Small": Status.STALLED,
    "Restoration_Failed": Status.STALLED,
    "Error_In_Step_Computation": Status.STALLED,
    "Diverging_Iterates": Status.DIVERGED,
    "Invalid_Number_Detected": Status.INVALID_NUMBER,
    "Not_Enough_Degrees_Of_Freedom": Status.OVERDETERMINED,
}

LINEAR_SOLVERS = ("mumps", "spral")
LOADED = dict.fromkeys(("ma27", "ma57", "ma77", "ma86", "ma97"), "hsllib") | {"pardiso": "pardisolib"}
"""Linear solvers that IPOPT loads from a library, with the option that gives its path."""

NO_FILE: Mapping[str, object] = {"option_file_name": ""}
"""Without it IPOPT reads ``ipopt.opt`` of the working folder, which may load a library or overwrite a file."""


@dataclass(frozen=True)
class Ipopt(Solver):
    """IPOPT with exact Jacobian and Hessian.

    Newton systems are regularised by 1e-13 mu^(1/4) in the rows, so that redundant rows do not make them singular.

    Parameters
    ----------
    tolerance : float
        Optimality tolerance on the scaled problem (``tol``).
    max_iterations : int
        Largest number of iterations (``max_iter``).
    time_limit : float or None
        Wall-clock time of one solve [s]. Solves on finer meshes, with added rows and by restarts are further solves.
    barrier : str
        ``mu_strategy``: "monotone" finds the local optimum next to the guess. "adaptive" often takes fewer iterations
        and may find another one.
    initial_barrier : float
        ``mu_init``. The default is a tenth of IPOPT's, since the cost of one control falls as the mesh gets finer. A
        larger barrier would then push the controls away from the guess.
    linear_solver : str
        Solver of the symmetric systems, by its name in IPOPT: "mumps" or "spral". With a library in the options
        ``hsllib`` or ``pardisolib`` it may be "ma27", "ma57", "ma77", "ma86", "ma97" or "pardiso".
    options : mapping
        Further options by their names in IPOPT; they override the fields above.

    Raises
    ------
    InputError
        A tolerance, a number of iterations, a time or a barrier is no number above 0. The linear solver is unknown, or
        ``options`` do not give the path of its library.
    """

    tolerance: float = TOLERANCE
    max_iterations: int = MOST_ITERATIONS
    time_limit: float | None = None
    barrier: str = "monotone"
    initial_barrier: float = BARRIER
    linear_solver: str = "mumps"
    options: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        no_mapping("Ipopt", self.tolerance)
        above_zero("Ipopt(tolerance)", self.tolerance, most=LOOSEST)
        counted("Ipopt(max_iterations)", self.max_iterations)
        if self.time_limit is not None:
            above_zero("Ipopt(time_limit)", self.time_limit, "s")
        above_zero("Ipopt(initial_barrier)", self.initial_barrier)
        named_options("Ipopt(options)", self.options)
        if self.linear_solver not in (*LINEAR_SOLVERS, *LOADED):
            raise InputError(
                f"Ipopt(linear_solver) is one of {', '.join((*LINEAR_SOLVERS, *LOADED))}; got {self.linear_solver!r}."
            )
        library = LOADED.get(self.linear_solver)
        if library and library not in self.options:
            raise InputError(
                f'Ipopt(linear_solver="{self.linear_solver}") is in a library of your own: give its path as '
                f'options={{"{library}": ...}}, or take one of {", ".join(LINEAR_SOLVERS)}.'
            )

    def at_most(self, iterations: int) -> Ipopt:
        """Return this solver with no more than these iterations."""
        return replace(self, max_iterations=min(self.max_iterations, iterations))

    def accurate_to(self, tolerance: float) -> Ipopt:
        """Return this solver with no larger tolerance."""
        return replace(self, tolerance=min(self.tolerance, tolerance))

    def with_early_stop(self) -> Ipopt:
        """Return this solver with a tenth of its iterations."""
        return self.at_most(max(1, self.max_iterations // 10))

    def within(self, seconds: float) -> Ipopt:
        """Return this solver with a limit of processor seconds for one solve."""
        return replace(self, time_limit=min(seconds, self.time_limit or seconds))

    def with_smaller_gap(self, factor: float) -> Ipopt:
        """Return this solver with a smaller last barrier, unless ``options`` set ``compl_inf_tol``."""
        if "compl_inf_tol" in self.options:
            return self
        return replace(self, options={"compl_inf_tol": max(factor * self.tolerance, ROUND_OFF), **self.options})

    def _options(self, warm: bool) -> dict[str, object]:
        options: dict[str, object] = {
            "tol": self.tolerance,
            "constr_viol_tol": self.tolerance,
            # IPOPT's own level of 1e-6 lets a motion pass that is a third longer than the optimum.
            "acceptable_tol": max(10.0 * self.tolerance, Ipopt.tolerance),
            "max_iter": self.max_iterations,
            "mu_strategy": self.barrier,
            "mu_init": self.initial_barrier,
            "print_level": 0,
            "sb": "yes",
            **NO_FILE,
            # Bounds hold at the solution. IPOPT relaxes them by 1e-8 while it iterates. Restoring them then changes
            # rows with steep gradients by more than their tolerance.
            "honor_original_bounds": "yes",
            "bound_relax_factor": BOUND_RELAXATION,
            # Rows may be redundant, such as a periodic link on a conserved quantity. The rounding error of a zero pivot
            # would then determine the inertia and the iterates. Every system is regularised instead. Near a straight
            # knee rows are almost dependent, and IPOPT's default of 1e-8 converges slowly or diverges there.
            "perturb_always_cd": "yes",
            "jacobian_regularization_value": 1e-13,
            "linear_solver": self.linear_solver,
        }
        if self.linear_solver == "mumps":
            # By default IPOPT allocates eleven times the memory that MUMPS estimates. Such a block is allocated and
            # cleared for every factorisation, which takes a seventh of the time of legged plans. If twice the estimate
            # is too little, IPOPT increases it.
            options["mumps_mem_percent"] = 100
        if self.time_limit is not None:
            options["max_cpu_time"] = self.time_limit
        if warm:
            options |= {
                "warm_start_init_point": "yes",
                "mu_init": NEARBY_BARRIER,
                **dict.fromkeys(PUSHES, 1e-7),
            }
        return options | dict(self.options)

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """Solve from ``nlp.guess``."""
        functions = nlp.functions
        # The time of their assembly belongs to building the problem.
        began = used_time()
        n_w = len(nlp.variables)
        if multipliers is not None and multipliers.sizes != (len(nlp.rows), n_w):
            multipliers = None
        lower, upper = nlp.rows.lower * nlp.row_scale, nlp.rows.upper * nlp.row_scale
        callback = IterationCallback(n_w, lower, upper, progress, lambda w: Origin(nlp, w * nlp.scale))
        w, p = ca.MX.sym("w", n_w), ca.MX.sym("p", 0)
        # A call makes a constant objective sparse again, which nlpsol refuses.
        objective = ca.densify(functions.objective(w, p))
        oracle = {"x": w, "p": p, "f": objective, "g": functions.rows(w, p)}
        scale = nlp.objective_scale(float(functions.objective(nlp.guess / nlp.scale, [])))
        try:
            solver = ca.nlpsol(
                "solver",
                "ipopt",
                oracle,
                {
                    "grad_f": functions.gradient,
                    "jac_g": functions.jacobian,
                    "hess_lag": functions.hessian,
                    "iteration_callback": callback,
                    "calc_lam_p": False,
                    "no_nlp_grad": True,
                    "print_time": False,
                    "error_on_fail": False,
                    "show_eval_warnings": False,
                    "ipopt": {**_unit(scale), **self._options(multipliers is not None)},
                },
            )
        except RuntimeError as error:
            told = sub(r"\S+\.[ch]pp:\d+: (Error calling \S+ for \S+ )?", "", " ".join(str(error).split()))
            raise InputError(
                f"IPOPT refuses the options {dict(self.options)!r}: {told[-200:].rstrip('.')}. Its manual lists them; "
                "iterations and seconds are max_iterations= and time_limit= of rt.Ipopt."
            ) from error
        arguments = {
            "x0": nlp.guess / nlp.scale,
            "lbx": nlp.variables.lower / nlp.scale,
            "ubx": nlp.variables.upper / nlp.scale,
            "lbg": lower,
            "ubg": upper,
        }
        if multipliers is not None:
            arguments |= {"lam_g0": multipliers.rows / nlp.row_scale, "lam_x0": multipliers.bounds * nlp.scale}
        ready = used_time()
        with callback.interruptible():
            result = solver(**arguments)
        if callback.error is not None:
            raise callback.error
        ended = used_time()
        stats = solver.stats()
        message = str(stats["return_status"])
        status = Status.INTERRUPTED if callback.stop else STATUSES.get(message, Status.SOLVER_ERROR)
        point, lam_g, lam_x = (np.array(result[key]).ravel() for key in ("x", "lam_g", "lam_x"))
        if not np.all(np.isfinite(point)) and callback.last is not None:
            point = callback.last
        parts = {
            "solve: functions": sum(value for key, value in stats.items() if key.startswith("t_proc_nlp_")),
            "solve: progress": float(stats.get("t_proc_callback_fun", 0.0)),
        }
        parts["solve: linear algebra and steps"] = max(0.0, ended - ready - sum(parts.values()))
        return Outcome(
            status,
            message.replace("_", " "),
            point * nlp.scale,
            _multipliers(nlp, point * nlp.scale, lam_g, lam_x),
            # With more equations than unknowns IPOPT does not start and does not set its count.
            0 if status is Status.OVERDETERMINED else int(stats["iter_count"]),
            {"setup": ready - began, "solve": ended - ready, **parts},
        )


def _unit(scale: float) -> dict[str, float]:
    """Return IPOPT's options for an objective times ``scale``. Its tolerances are in the unit of the objective."""
    return {"obj_scaling_factor": scale, "dual_inf_tol": 1.0 / scale, "compl_inf_tol": 1e-4 / scale}


def _multipliers(nlp: Nlp, w: np.ndarray, lam_g: np.ndarray, lam_x: np.ndarray) -> Multipliers:
    """Return multipliers in physical units, with the NLP for solves of the same problem with other ends."""
    known = Multipliers(lam_g * nlp.row_scale, lam_x / nlp.scale)
    return LazyMultipliers(lambda: known, known.sizes, Origin(nlp, w))
