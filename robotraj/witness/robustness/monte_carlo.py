"""Many simulations of a plan in MuJoCo under its own gains, each with other disturbances."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError, require_solution
from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.witness.mujoco.model import MujocoRobot, mujoco_robot
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.planned import limits_of, robot_sample
from robotraj.witness.protocols import Array, RobotLike, SolutionLike
from robotraj.witness.robustness.disturbances import PUSH_TIME, Disturbances

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SUBSTEPS = 2
"""Steps of MuJoCo in a period of the controller."""
CONFIDENCE = 1.96
"""Standard deviations of a 95 percent interval."""
LEAST_RESERVE = 1e-3
"""Least reserve of a motor, relative to its limit of effort."""
SHARES = (50, 90, 100)
"""Percentiles that the funnel plot draws."""


@dataclass(frozen=True, eq=False)
class MonteCarlo(OneLine):
    """The runs of ``monte_carlo``.

    Attributes
    ----------
    times : ndarray (m,)
        Times of the controller's periods [s].
    deviations : ndarray (runs, m)
        Largest deviation of a joint's position from the plan [rad, m]; infinite after a simulation diverged.
    used : ndarray (runs,)
        Largest feedback torque relative to the reserve of its motor; above 1 the motor saturated. The reserve is the
        distance of the planned torque from the limit of effort in the direction of the feedback.
    bound : float
        Largest deviation of a run that counts as held [rad, m].
    seed : int
    disturbances : Disturbances
    how : str
        Description of the simulator.
    """

    times: Array
    deviations: Array
    used: Array
    bound: float
    seed: int
    disturbances: Disturbances
    how: str

    @property
    def worst(self) -> Array:
        """Largest deviation of each run (runs,)."""
        return np.asarray(self.deviations.max(axis=1))

    @property
    def held(self) -> float:
        """Share of the runs that stayed within the bound."""
        return float(np.mean(self.worst <= self.bound))

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 percent confidence of ``held``.

        Source: Wilson, Probable inference, the law of succession, and statistical inference, J. Amer. Statist. Assoc.
        22 (1927).
        """
        n, z = len(self.deviations), CONFIDENCE
        centre = (self.held + 0.5 * z**2 / n) / (1.0 + z**2 / n)
        half = z / (1.0 + z**2 / n) * np.sqrt(self.held * (1.0 - self.held) / n + 0.25 * z**2 / n**2)
        return max(0.0, float(centre - half)), min(1.0, float(centre + half))

    def plot(self) -> Figure:
        """Draw the funnel: percentiles of the deviation over time, and the bound.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7.0, 3.5), layout="constrained")
        axes = figure.subplots()
        finite = np.where(np.isfinite(self.deviations), self.deviations, np.nan)
        for share in SHARES:
            curve = np.nanpercentile(finite, share, axis=0)
            axes.fill_between(self.times, 0.0, curve, alpha=0.25, color="C0", linewidth=0.0)
            axes.plot(self.times, curve, color="C0", linewidth=1.0, label=f"{share} percent of the runs")
        axes.axhline(self.bound, color="C3", linestyle="--", label="bound")
        axes.set(xlabel="t [s]", ylabel="largest deviation [rad, m]", xlim=(self.times[0], self.times[-1]))
        axes.legend(loc="upper left")
        return figure

    def __str__(self) -> str:
        low, high = self.interval
        kept = int(np.sum(self.worst <= self.bound))
        lines = wrapped(
            f"{kept} of {len(self.worst)} runs stayed within {self.bound:g} rad or m of the plan: "
            f"{100 * low:.1f} to {100 * high:.1f} percent with 95 percent confidence"
        )
        middle, most = np.median(self.worst), self.worst.max()
        lines += wrapped(f"largest deviation: median {middle:.2e}, most {most:.2e}", "  ")
        lines += wrapped(
            f"share of the torque reserve: median {np.median(self.used):.2g}, most {self.used.max():.2g}", "  "
        )
        lines += wrapped(f"seed {self.seed}, {self.how}", "  ")
        return "\n".join(lines)


def monte_carlo(
    solution: SolutionLike,
    runs: int = 100,
    *,
    disturbances: Disturbances | None = None,
    bound: float = 0.1,
    seed: int = 0,
    rate: float = 1000.0,
) -> MonteCarlo:
    """Simulate a plan in MuJoCo many times under tau = tau_plan - K(t) e, with random disturbances.

    The controller measures positions and velocities with noise at its rate. After the delay it applies the torque of
    ``solution.gains``, clipped at the phase's limits of effort, for one period.

    Parameters
    ----------
    solution : Solution
        A plan of a robot with a fixed root and without contacts. ``rt.witness.second_opinion`` simulates others.
    runs : int
    disturbances : Disturbances, optional
    bound : float
        Largest deviation of a joint's position that counts as held [rad, m].
    seed : int
        The same seed gives the same runs.
    rate : float
        Rate of the controller [Hz].

    Returns
    -------
    MonteCarlo
        ``print`` shows the share of runs that stayed within the bound and its interval of confidence.

    Raises
    ------
    InputError
        MuJoCo is not installed, the plan has contacts, a moving root or no robot, or a number is not above 0.
    """
    require_solution(solution, "rt.witness.monte_carlo")
    robot = solution.phases[0].phase.robot
    if robot is None or robot.root != "fixed" or any(part.phase.contacts for part in solution.phases):
        raise InputError(
            "rt.witness.monte_carlo takes the plan of a robot with a fixed root and without contacts; "
            "rt.witness.second_opinion simulates others."
        )
    if isinstance(runs, bool) or not isinstance(runs, int) or runs < 1:
        raise InputError(f"runs is {runs!r}; give a whole number of 1 or more.")
    for name, value in (("bound", bound), ("rate", rate)):
        if not 0.0 < value < np.inf:
            raise InputError(f"{name} is {value!r}; it must be above 0.")
    mujoco, drawn = load_mujoco(), disturbances or Disturbances()
    plant = mujoco_robot(robot)
    loop = _Loop(solution, robot, rate)
    found = [loop.run(mujoco, plant, drawn, rng) for rng in _generators(seed, runs)]
    deviations, used = np.array([each for each, _ in found]), np.array([share for _, share in found])
    how = f"MuJoCo {mujoco.__version__}, RK4, controller at {rate:g} Hz"
    return MonteCarlo(loop.times, deviations, used, float(bound), seed, drawn, how)


def _generators(seed: int, runs: int) -> Iterator[np.random.Generator]:
    """Yield one independent generator a run, so that a run does not depend on the number of runs."""
    return (np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(runs))


class _Loop:
    """A plan for its controller: set points, torques and gains at the controller's times."""

    def __init__(self, solution: SolutionLike, robot: RobotLike, rate: float) -> None:
        parts = solution.phases
        first, last = float(parts[0].knots[0]), float(parts[-1].knots[-1])
        count = max(1, int(np.ceil((last - first) * rate - 1e-9)))
        self.times = np.linspace(first, last, count + 1)
        self.period = float(self.times[1] - self.times[0])
        starts = np.array([part.knots[0] for part in parts])
        owner = np.clip(np.searchsorted(starts, self.times, side="right") - 1, 0, len(parts) - 1)
        samples = [robot_sample(part, self.times[owner == i]) for i, part in enumerate(parts) if (owner == i).any()]
        self.q, self.v, self.tau = (
            np.concatenate([getattr(sample, name) for sample in samples]) for name in ("q", "v", "tau")
        )
        gains = solution.gains
        self.gains = np.array([gains.at(float(t)) for t in self.times])
        self.actuation = np.asarray(robot.actuation, dtype=float)
        chosen = [robot.velocity_names.index(joint) for joint in robot.actuated]
        limits = [limits_of(part) for part in parts]
        efforts = [np.full(len(chosen), np.inf) if known is None else known.effort[chosen] for known in limits]
        self.effort = np.array(efforts)[owner]

    def run(
        self, mujoco: ModuleType, plant: MujocoRobot, drawn: Disturbances, rng: np.random.Generator
    ) -> tuple[Array, float]:
        """Return the largest deviation at every time (m,), and the largest feedback relative to a reserve."""
        model = drawn.of_model(mujoco, plant.model, rng)
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        model.opt.timestep = self.period / SUBSTEPS
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        data, where = mujoco.MjData(model), plant.coordinates
        nv = self.v.shape[1]
        q = self.q[0] + drawn.position * rng.standard_normal(nv)
        data.qpos[:] = where.qpos(q)
        data.qvel[:] = where.qvel(q, self.v[0] + drawn.velocity * rng.standard_normal(nv))
        body, begin, force = drawn.push_of(model.nbody, float(self.times[-1] - self.times[0]), rng)
        waiting = [self.tau[0]] * round(drawn.delay / self.period)
        found, used = np.full(len(self.times), np.inf), 0.0
        for k, t in enumerate(self.times - self.times[0]):
            q = where.q(data.qpos)
            v = where.v(q, data.qvel)
            if not (np.isfinite(q).all() and np.isfinite(v).all()):
                break
            found[k] = np.max(np.abs(q - self.q[k]))
            if k == len(self.times) - 1:
                break
            noise = rng.standard_normal((2, nv))
            error = np.concatenate(
                [q - self.q[k] + drawn.position_noise * noise[0], v - self.v[k] + drawn.velocity_noise * noise[1]]
            )
            added = -self.gains[k] @ error
            reserve = np.maximum(self.effort[k] - np.sign(added) * self.tau[k], LEAST_RESERVE * self.effort[k])
            used = max(used, float(np.max(np.abs(added) / reserve)))
            waiting.append(np.clip(self.tau[k] + added, -self.effort[k], self.effort[k]))
            data.qfrc_applied[:] = where.force(q, self.actuation @ waiting.pop(0))
            data.xfrc_applied[body, :3] = force if begin <= t < begin + PUSH_TIME else 0.0
            for _ in range(SUBSTEPS):
                mujoco.mj_step(model, data)
        return found, used
