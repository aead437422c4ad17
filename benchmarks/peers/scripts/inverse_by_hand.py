"""Written by hand: Hermite-Simpson on q, v, a with inverse dynamics, derivatives assembled from a point's, IPOPT.

Variables are q, v and a at the knots and mid-points; the collocation of q' = v, v' = a is linear, torques are rows. A
point's torques, their Jacobian and the Hessian of its share of the Lagrangian are CasADi functions of 3 nq numbers.
CasADi's virtual machine evaluates them at all points, and their entries are copied to their places. A free duration T
is one more argument of every point, of which v and a are then derivatives by s = t / T: the collocation stays linear.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
from report import Report, inside, requested_task, urdf
from rnea import rnea
from scipy.sparse import coo_array, csc_array, hstack, kron, vstack
from tasks import Task

NODES = np.array([0.0, 0.5, 1.0])


def collocation(task: Task, h: float) -> csc_array:
    """Rows of q' = v and v' = a, on all points' (q, v, a)."""
    n, nq = task.intervals, len(task.joints)
    # y2 - y0 = h / 6 (r0 + 4 r1 + r2);  y1 = (y0 + y2) / 2 + h / 8 (r0 - r2)
    values = np.array([[-1.0, 0, 1], [-0.5, 1, -0.5]])
    rates = h * np.array([[-1 / 6, -4 / 6, -1 / 6], [-1 / 8, 0, 1 / 8]])
    pick = np.eye(3)
    stencil = kron(values, pick[:2]) + kron(rates, pick[1:])  # (two rows, q or v) by (three points, q v a)
    stencil = kron(stencil, np.eye(nq)).tocoo()
    step, width = stencil.shape[0], 6 * nq  # an interval moves on by two points
    k = np.repeat(np.arange(n), stencil.nnz)
    place = np.tile(stencil.row, n) + step * k, np.tile(stencil.col, n) + width * k
    return coo_array((np.tile(stencil.data, n), place), shape=(step * n, 3 * nq * (2 * n + 1))).tocsc()


class Assembled:
    """A sparse matrix as a CasADi expression of the values of its entries; entries of one place are added up."""

    def __init__(self, rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]) -> None:
        places, index = np.unique(columns.astype(np.int64) * shape[0] + rows, return_inverse=True)
        row, column = (places % shape[0]).tolist(), (places // shape[0]).tolist()
        self.sparsity = ca.Sparsity.triplet(*shape, row, column)
        order = np.argsort(index, kind="stable")
        self.order = order.tolist()
        self.repeated = len(places) < len(rows)
        ones = csc_array((np.ones(len(rows)), (index, np.arange(len(rows)))), shape=(len(places), len(rows)))
        self.sum = ca.DM(ones)

    def __call__(self, values: Any) -> Any:
        """Fill in."""
        return ca.MX(self.sparsity, self.sum @ values if self.repeated else values[self.order])


def solve(task: Task) -> None:
    """Transcribe, solve, report."""
    model = pin.buildModelFromUrdf(urdf(task))
    nq, points = model.nv, 2 * task.intervals + 1
    least, most = task.durations
    free = most > least
    width, count = 3 * nq, 3 * nq * points
    size = count + free

    # A point: torques, their Jacobian, the Hessian of its part of the Lagrangian.
    z, end, weight, lam = ca.SX.sym("z", width), ca.SX.sym("T"), ca.SX.sym("weight"), ca.SX.sym("lam", nq)
    given = ca.vertcat(z, end) if free else z
    scale = end if free else 1.0
    tau = rnea(model, z[:nq], z[nq : 2 * nq] / scale, z[2 * nq :] / scale**2)
    effort = task.objective == "effort"
    motors = np.zeros(nq)
    motors[list(task.actuated)] = 1.0
    pull = ca.DM(motors) * tau
    cost = ca.sumsqr(pull) if effort else ca.SX(0)
    jacobian, gradient = ca.jacobian(tau, given), ca.densify(ca.gradient(cost, given))
    hessian = ca.hessian(ca.dot(lam, tau), given)[0]
    if effort:  # of the square: twice J'J, and the torques' own with 2 tau among the multipliers
        pulls = ca.jacobian(pull, given)
        hessian = ca.substitute(hessian, lam, lam + 2 * weight * pull) + 2 * weight * pulls.T @ pulls
    hessian = ca.triu(hessian)
    names = [z, end, weight, lam]
    values = ca.Function("values", [z, end], [tau, cost]).map(points)
    slopes = ca.Function("slopes", [z, end], [ca.vertcat(*jacobian.nonzeros())]).map(points)
    ascent = ca.Function("ascent", [z, end], [gradient]).map(points)
    curves = ca.Function("curves", names, [ca.vertcat(*hessian.nonzeros())]).map(points)

    # The whole: linear rows, torques, and their derivatives put in place.
    length = 1.0 if free else least
    h = length / task.intervals
    simpson = np.zeros(points)
    for k in range(task.intervals):
        simpson[2 * k : 2 * k + 3] += h / 6 * np.array([1, 4, 1])
    linear = hstack([collocation(task, h), csc_array((4 * nq * task.intervals, int(free)))]).tocsc()
    lower, upper = [np.zeros(linear.shape[0])], [np.zeros(linear.shape[0])]
    speed = np.array(task.velocity)
    if free and np.isfinite(speed).all():  # |v / T| within the limit
        at_v = kron(np.eye(points), np.eye(3)[1:2])
        for sign in (1.0, -1.0):
            both = hstack([kron(sign * at_v, np.eye(nq)), -np.tile(speed, points)[:, None]])
            linear = vstack([linear, both]).tocsc()
            lower, upper = [*lower, np.full(nq * points, -np.inf)], [*upper, np.zeros(nq * points)]
    most_pull = np.zeros(nq)
    most_pull[list(task.actuated)] = task.effort
    lower, upper = [*lower, np.tile(-most_pull, points)], [*upper, np.tile(most_pull, points)]
    lines = linear.shape[0]

    w, sigma, duals = ca.MX.sym("w", size), ca.MX.sym("sigma"), ca.MX.sym("duals", lines + nq * points)
    at = ca.reshape(w[:count], width, points)
    ends = ca.repmat(w[count], 1, points) if free else ca.DM(1, points)
    torques, costs = values(at, ends)
    steady = linear.tocoo()

    def spread(sparsity: Any, down: int) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns of every point's entries; ``down`` rows a point, the duration last."""
        row, column = (np.array(part, dtype=np.int64) for part in sparsity.get_triplet())
        k = np.arange(points)[:, None]
        return (
            np.where(row == width, count, row + down * k).ravel(),
            np.where(column == width, count, column + width * k).ravel(),
        )

    rows, columns = spread(jacobian.sparsity(), nq)
    whole = Assembled(np.r_[steady.row, lines + rows], np.r_[steady.col, columns], (lines + nq * points, size))
    jac = whole(ca.vertcat(ca.DM(steady.data), ca.vec(slopes(at, ends))))
    shares = sigma * ca.DM(simpson).T if effort else ca.DM(1, points)
    second = Assembled(*spread(hessian.sparsity(), width), (size, size))
    hess = second(ca.vec(curves(at, ends, shares, ca.reshape(duals[lines:], nq, points))))
    if effort:
        objective = ca.dot(ca.DM(simpson), ca.vec(costs))
        grads = ascent(at, ends) * ca.repmat(ca.DM(simpson).T, width + free, 1)
        grad = ca.vertcat(ca.vec(grads[:width, :]), ca.sum2(grads[width, :])) if free else ca.vec(grads)
    else:
        objective, grad = w[count], ca.vertcat(ca.DM.zeros(count), 1)

    # Bounds, the straight line, IPOPT.
    reach = [np.array(part) for part in task.position]
    swift = np.full(nq, np.inf) if free else speed
    low = np.tile(np.r_[reach[0], -swift, np.full(nq, -np.inf)], (points, 1))
    high = np.tile(np.r_[reach[1], swift, np.full(nq, np.inf)], (points, 1))
    guess = np.zeros((points, width))
    guess[:, :nq] = np.linspace(task.start, task.end, points)
    guess[:, nq : 2 * nq] = (np.array(task.end) - task.start) / length
    for j, rest in ((0, task.start), (-1, task.end)):
        low[j, : 2 * nq] = high[j, : 2 * nq] = np.r_[rest, np.zeros(nq)]
    last = [[least], [most], [task.guess]] if free else [[], [], []]
    x = {"x": w, "f": objective, "g": ca.vertcat(ca.DM(linear) @ w, ca.vec(torques)), "p": ca.MX.sym("p", 0)}
    options = {
        "grad_f": ca.Function("grad_f", [w, x["p"]], [objective, ca.densify(grad)]),
        "jac_g": ca.Function("jac_g", [w, x["p"]], [x["g"], jac]),
        "hess_lag": ca.Function("hess_lag", [w, x["p"], sigma, duals], [hess]),
        "calc_lam_p": False,
        "no_nlp_grad": True,
        "print_time": False,
        "record_time": True,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "max_cpu_time": 120.0,
            "mu_init": 1e-2,
            "mu_strategy": "adaptive" if free else "monotone",  # halves the iterations of minimum time
        },
    }
    solver = ca.nlpsol("solver", "ipopt", x, options)
    answer = solver(
        x0=np.r_[guess.ravel(), last[2]],
        lbx=np.r_[low.ravel(), last[0]],
        ubx=np.r_[high.ravel(), last[1]],
        lbg=np.concatenate(lower),
        ubg=np.concatenate(upper),
    )
    stats = solver.stats()
    report = Report(
        (stats["t_wall_total"], stats["t_proc_total"]), stats["iter_count"], stats["success"], stats["return_status"]
    )
    found = np.array(answer["x"]).ravel()
    total = float(found[count]) if free else least
    q, v, a = np.split(found[:count].reshape(points, width), 3, axis=1)
    if free:
        v, a = v / total, a / total**2
    chosen = list(task.actuated)
    tau = np.array(answer["g"]).ravel()[lines:].reshape(points, nq)[:, chosen]
    interpolate(report, task, total, q, v, a, tau)


def interpolate(report: Report, task: Task, total: float, *parts: np.ndarray) -> None:
    """Sample what was collocated: q and v cubics with the rates of three points, torques parabolas."""
    q, v, a, tau = (np.stack([part[j : j + 2 * task.intervals : 2] for j in range(3)], axis=1) for part in parts)
    t = inside(np.linspace(0, total, task.intervals + 1))
    s = np.linspace(0, 1, t.shape[1])
    h = total / task.intervals
    basis = [np.polynomial.Polynomial.fit(NODES, row, 2, domain=[0, 1], window=[0, 1]) for row in np.eye(3)]
    inner = np.array([each(s) for each in basis])
    integrals = np.array([each.integ()(s) for each in basis]) * h
    report.write(
        t,
        q[:, :1] + np.einsum("js,kji->ksi", integrals, v),
        v[:, :1] + np.einsum("js,kji->ksi", integrals, a),
        np.einsum("js,kji->ksi", inner, tau),
    )


if __name__ == "__main__":
    solve(requested_task())
