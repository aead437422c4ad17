"""The control loop of a plan in MuJoCo: one run under the plan's gains with drawn disturbances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, require_solution
from robotraj.witness.mujoco.model import mujoco_robot
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.planned import limits_of, robot_sample
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.robustness.disturbances import PUSH_TIME, Disturbances

SUBSTEPS = 2
"""Steps of MuJoCo in a period of the controller."""
LEAST_RESERVE = 1e-3
"""Least reserve of a motor, relative to its limit of effort."""


def generators(seed: int, runs: int, first: int = 0) -> Iterator[np.random.Generator]:
    """Yield the generators of ``runs`` runs from number ``first`` on; a run does not depend on how many there are."""
    return (np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(first + runs)[first:])


def whole(**numbers: int) -> None:
    """Raise an InputError for a number of runs that is no whole number of 1 or more."""
    for name, value in numbers.items():
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise InputError(f"{name} is {value!r}; give a whole number of 1 or more.")


def above_zero(**numbers: float) -> None:
    """Raise an InputError for a number that is not above 0 and finite."""
    for name, value in numbers.items():
        if not 0.0 < value < np.inf:
            raise InputError(f"{name} is {value!r}; it must be above 0.")


class Loop:
    """A plan for its controller: set points, torques and gains at the controller's times.

    Parameters
    ----------
    solution : Solution
        A plan of a robot with a fixed root and without contacts.
    rate : float
        Rate of the controller [Hz].
    caller : str
        Name of the public function, for messages.

    Raises
    ------
    InputError
        MuJoCo is not installed, the plan has contacts, a moving root or no robot, or the rate is not above 0.
    """

    def __init__(self, solution: SolutionLike, rate: float, caller: str) -> None:
        require_solution(solution, caller)
        parts, robot = solution.phases, solution.phases[0].phase.robot
        if robot is None or robot.root != "fixed" or any(part.phase.contacts for part in parts):
            raise InputError(
                f"{caller} takes the plan of a robot with a fixed root and without contacts; "
                "rt.witness.second_opinion simulates others."
            )
        above_zero(rate=rate)
        self.mujoco, self.plant = load_mujoco(), mujoco_robot(robot)
        self.how = f"MuJoCo {self.mujoco.__version__}, RK4, controller at {rate:g} Hz"
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
        free = np.full(len(chosen), np.inf)
        efforts = [(-free, free) if known is None else np.array(known.sides("effort"))[:, chosen] for known in limits]
        self.weakest, self.strongest = np.array(efforts)[owner].transpose(1, 0, 2)

    def run(self, drawn: Disturbances, rng: np.random.Generator) -> tuple[Array, float]:
        """Return the largest deviation at every time (m,), and the largest feedback relative to a reserve."""
        mujoco, plant = self.mujoco, self.plant
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
            low, high = self.weakest[k], self.strongest[k]
            left = np.where(added > 0.0, high - self.tau[k], self.tau[k] - low)
            reserve = np.maximum(left, LEAST_RESERVE * np.maximum(-low, high))
            used = max(used, float(np.max(np.abs(added) / reserve)))
            waiting.append(np.clip(self.tau[k] + added, low, high))
            data.qfrc_applied[:] = where.force(q, self.actuation @ waiting.pop(0))
            data.xfrc_applied[body, :3] = force if begin <= t < begin + PUSH_TIME else 0.0
            for _ in range(SUBSTEPS):
                mujoco.mj_step(model, data)
        return found, used
