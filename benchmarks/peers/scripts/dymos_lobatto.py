"""Dymos's Gauss-Lobatto transcription of third order (Hermite-Simpson) with Pinocchio's analytical derivatives."""

from __future__ import annotations

from typing import Any

import dymos as dm
import numpy as np
import openmdao.api as om
import pinocchio as pin
from ipopt_driver import IpoptDriver
from report import Report, inside, requested_task, urdf
from tasks import Task


class Motion(om.ExplicitComponent):
    """Accelerations and effort at all nodes."""

    def initialize(self) -> None:
        """Declare the inputs and outputs."""
        self.options.declare("num_nodes", types=int)
        self.options.declare("task")

    def setup(self) -> None:
        """Declare inputs, outputs, one block a node."""
        n, task = self.options["num_nodes"], self.options["task"]
        self.model = pin.buildModelFromUrdf(urdf(task))
        self.data, nq, nu = self.model.createData(), self.model.nv, len(task.actuated)
        self.motors = np.eye(nq)[:, list(task.actuated)]
        for name, size in (("q", nq), ("v", nq), ("u", nu)):
            self.add_input(name, shape=(n, size))
            rows = (np.arange(n)[:, None, None] * nq + np.arange(nq)[:, None] + np.zeros((1, 1, size), int)).ravel()
            columns = (np.arange(n)[:, None, None] * size + np.zeros((nq, 1), int) + np.arange(size)).ravel()
            self.declare_partials("a", name, rows=rows, cols=columns)
        self.add_output("a", shape=(n, nq))
        self.add_output("power", shape=(n,))
        self.declare_partials("power", "u", rows=np.repeat(np.arange(n), nu), cols=np.arange(n * nu))

    def torques(self, inputs: Any, k: int) -> np.ndarray:
        """Motors less damping."""
        return self.motors @ inputs["u"][k] - self.model.damping * inputs["v"][k]

    def compute(self, inputs: Any, outputs: Any) -> None:
        """Forward dynamics."""
        for k in range(self.options["num_nodes"]):
            tau = self.torques(inputs, k)
            outputs["a"][k] = pin.aba(self.model, self.data, inputs["q"][k], inputs["v"][k], tau)
        outputs["power"] = np.sum(inputs["u"] ** 2, axis=1)

    def compute_partials(self, inputs: Any, partials: Any) -> None:
        """Its analytical derivatives."""
        blocks: dict[str, list[np.ndarray]] = {"q": [], "v": [], "u": []}
        damping = np.diag(self.model.damping)
        for k in range(self.options["num_nodes"]):
            tau = self.torques(inputs, k)
            pin.computeABADerivatives(self.model, self.data, inputs["q"][k], inputs["v"][k], tau)
            inverse = np.triu(self.data.Minv) + np.triu(self.data.Minv, 1).T
            blocks["q"].append(self.data.ddq_dq.copy())
            blocks["v"].append(self.data.ddq_dv - inverse @ damping)
            blocks["u"].append(inverse @ self.motors)
        for name, parts in blocks.items():
            partials["a", name] = np.concatenate([part.ravel() for part in parts])
        partials["power", "u"] = 2 * inputs["u"].ravel()


def limits(lower: Any, upper: Any, nodes: int) -> dict[str, Any]:
    """Return bounds in the format of Dymos 1.15.1 for vectors: those of all nodes that are not fixed, in order."""
    finite = np.isfinite(upper).all()
    return {"lower": np.tile(lower, nodes), "upper": np.tile(upper, nodes)} if finite else {}


def solve(task: Task) -> None:
    """Transcribe, solve, report."""
    nq, nu, n = len(task.joints), len(task.actuated), task.intervals
    least, most = task.durations
    free, effort = most > least, task.objective == "effort"
    problem = om.Problem(model=om.Group(), reports=False)
    problem.driver = IpoptDriver(
        print_level=0, sb="yes", max_cpu_time=120.0, hessian_approximation="limited-memory", max_iter=1000
    )
    problem.driver.declare_coloring(show_summary=False)
    phase = dm.Phase(
        ode_class=Motion,
        ode_init_kwargs={"task": task},
        transcription=dm.GaussLobatto(num_segments=n, order=3, compressed=True),
    )
    trajectory = problem.model.add_subsystem("trajectory", dm.Trajectory())
    trajectory.add_phase("phase", phase)
    if free:
        phase.set_time_options(fix_initial=True, duration_bounds=(least, most))
    else:
        phase.set_time_options(fix_initial=True, fix_duration=True)
    speed, force = np.array(task.velocity), np.array(task.effort)
    ends = {"fix_initial": True, "fix_final": True}
    phase.add_state("q", rate_source="v", targets=["q"], shape=(nq,), **ends, **limits(*task.position, n - 1))
    phase.add_state("v", rate_source="a", targets=["v"], shape=(nq,), **ends, **limits(-speed, speed, n - 1))
    bounds = limits(-force, force, 2 * n + 1)
    phase.add_control("u", targets=["u"], shape=(nu,), continuity=True, rate_continuity=False, **bounds)
    phase.add_timeseries_output("a")
    if effort:
        phase.add_state("effort", rate_source="power", fix_initial=True)
        phase.add_objective("effort", loc="final")
    else:
        phase.add_objective("time", loc="final")
    problem.setup(force_alloc_complex=False)
    rest = np.zeros(nq)
    phase.set_time_val(initial=0.0, duration=task.guess)
    phase.set_state_val("q", [task.start, task.end])
    phase.set_state_val("v", [rest, rest])
    phase.set_control_val("u", [np.zeros(nu), np.zeros(nu)])
    if effort:
        phase.set_state_val("effort", [0.0, 1.0])
    problem.run_driver()
    driver = problem.driver
    solved = driver.status in (0, 1)
    report = Report((driver.clock.wall, driver.clock.processor), driver.iterations, solved, driver.message)

    # What was collocated: cubics through values and rates at the ends, controls through three nodes.
    def nodes(name: str) -> np.ndarray:
        values = problem.get_val(f"trajectory.phase.timeseries.{name}")
        return values.reshape(n, 3, -1)

    times, q, v, a, u = (nodes(name) for name in ("time", "q", "v", "a", "u"))
    knots = np.r_[times[:, 0, 0], times[-1, -1, 0]]
    t, h = inside(knots), np.diff(knots)[:, None, None]
    s = np.linspace(0, 1, t.shape[1])[None, :, None]

    def cubic(x: np.ndarray, d: np.ndarray) -> np.ndarray:
        x0, x1, d0, d1 = x[:, :1], x[:, -1:], h * d[:, :1], h * d[:, -1:]
        return x0 * (1 + 2 * s) * (1 - s) ** 2 + d0 * s * (1 - s) ** 2 + x1 * s**2 * (3 - 2 * s) + d1 * s**2 * (s - 1)

    control = u[:, :1] * (1 - s) * (1 - 2 * s) + 4 * u[:, 1:2] * s * (1 - s) + u[:, 2:] * s * (2 * s - 1)
    report.write(t, cubic(q, v), cubic(v, a), control)


if __name__ == "__main__":
    solve(requested_task())
