"""Crocoddyl's BoxFDDP with RK4 on a task: torques boxed, limits of the state and the goal as penalties."""

from __future__ import annotations

import crocoddyl
import numpy as np
import pinocchio as pin
from report import SAMPLES, Clock, Report, inside, requested_task, urdf
from tasks import Task

GOAL, BARRIER = 1e6, 1e5
"""Weights of the penalties on the goal and on broken limits."""
ITERATIONS = 500


class Motors(crocoddyl.ActuationModelAbstract):
    """Torques of the joints that have a motor; Crocoddyl has no such model for a fixed base."""

    def __init__(self, state: crocoddyl.StateMultibody, motors: tuple[int, ...]) -> None:
        super().__init__(state, len(motors))
        self.selection = np.eye(state.nv)[:, list(motors)]

    def calc(self, data: crocoddyl.ActuationDataAbstract, x: np.ndarray, u: np.ndarray) -> None:
        """Torques of all joints."""
        data.tau = self.selection @ u

    def calcDiff(self, data: crocoddyl.ActuationDataAbstract, x: np.ndarray, u: np.ndarray) -> None:
        """Their derivative."""
        data.dtau_du = self.selection


def solve(task: Task) -> None:
    """Solve a task of fixed duration."""
    model = pin.buildModelFromUrdf(urdf(task))
    nq, n = model.nv, task.intervals
    step = task.durations[0] / n
    state = crocoddyl.StateMultibody(model)
    nu = len(task.actuated)
    actuation = crocoddyl.ActuationModelFull(state) if nu == nq else Motors(state, task.actuated)
    rest = np.zeros(nq)
    start, end = np.r_[task.start, rest], np.r_[task.end, rest]
    running, terminal = (crocoddyl.CostModelSum(state, nu) for _ in range(2))
    control = crocoddyl.ResidualModelControl(state, nu)
    running.addCost("effort", crocoddyl.CostModelResidual(state, control), 2.0)  # its quadratic has a half
    upper = np.r_[task.position[1], task.velocity]
    lower = np.r_[task.position[0], -np.array(task.velocity)]
    # Penalties start a little inside the limits.
    bounds = crocoddyl.ActivationBounds(np.maximum(lower, -1e6) * 0.99, np.minimum(upper, 1e6) * 0.99)
    inside_limits = crocoddyl.CostModelResidual(
        state,
        crocoddyl.ActivationModelQuadraticBarrier(bounds),
        crocoddyl.ResidualModelState(state, np.zeros(2 * nq), nu),
    )
    running.addCost("limits", inside_limits, BARRIER)
    goal = crocoddyl.CostModelResidual(state, crocoddyl.ResidualModelState(state, end, nu))
    terminal.addCost("goal", goal, GOAL)
    actions = []
    for costs, length in ((running, step), (terminal, 0.0)):
        dynamics = crocoddyl.DifferentialActionModelFreeFwdDynamics(state, actuation, costs)
        action = crocoddyl.IntegratedActionModelRK(dynamics, crocoddyl.RKType.four, length)
        action.u_lb, action.u_ub = -np.array(task.effort), np.array(task.effort)
        actions.append(action)
    problem = crocoddyl.ShootingProblem(start, [actions[0]] * n, actions[1])
    # Its wheel uses two threads regardless of OMP_NUM_THREADS, which spin while cores are busy.
    problem.nthreads = 1
    solver = crocoddyl.SolverBoxFDDP(problem)
    solver.th_stop = 1e-7
    states = list(np.linspace(start, end, n + 1))
    with Clock() as clock:
        solved = solver.solve(states, [np.zeros(nu)] * n, ITERATIONS, False)
    report = Report(
        (clock.wall, clock.processor),
        solver.iter,
        bool(solved),
        "converged" if solved else f"not converged in {ITERATIONS} iterations",
    )
    # Its interpolant: the motion under controls held constant, which it integrates step by step.
    t = inside(np.arange(n + 1) * step)
    x = np.zeros((n, SAMPLES, 2 * nq))
    u = np.repeat(np.array(list(solver.us))[:, None, :], SAMPLES, axis=1)
    data, h = model.createData(), step / (SAMPLES - 1)
    motors = np.eye(nq)[:, list(task.actuated)]

    def rate(y: np.ndarray, torque: np.ndarray) -> np.ndarray:
        return np.r_[y[nq:], pin.aba(model, data, y[:nq], y[nq:], motors @ torque)]

    for k in range(n):
        x[k, 0] = solver.xs[k]
        for j in range(SAMPLES - 1):
            y, torque = x[k, j], u[k, j]
            k1 = rate(y, torque)
            k2 = rate(y + h / 2 * k1, torque)
            k3 = rate(y + h / 2 * k2, torque)
            x[k, j + 1] = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3, torque))
    report.write(t, x[..., :nq], x[..., nq:], u)


if __name__ == "__main__":
    solve(requested_task())
