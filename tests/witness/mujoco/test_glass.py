"""A glass of water, carried by a ur5 in MuJoCo under the exported gains: it stays upright at every simulated step."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness.mujoco.model import mujoco_robot

mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")

HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
PLANNED, ALLOWED = np.deg2rad(0.5), np.deg2rad(1.0)
RATE, SUBSTEPS = 1000.0, 4


def pose(robot: rt.Robot, q: np.ndarray) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return pin.SE3(data.oMf[robot.frame("tool0")])


def test_a_glass_stays_within_one_degree_between_knots_and_under_gains_in_mujoco() -> None:
    robot = rt.load("ur5")
    first = pose(robot, HOME)
    up = first.rotation.T @ [0, 0, 1]

    def tilt(q: np.ndarray) -> float:
        return float(np.arccos(np.clip((pose(robot, q).rotation @ up)[2], -1.0, 1.0)))

    rows = [
        rt.constraints.FrameAxis("tool0", axis=up, angle=PLANNED),
        rt.AtEnd(rt.FramePosition("tool0", first.translation + [-0.1, 0.45, 0.1])),
    ]
    slow = robot.limits.with_(velocity=1.5, acceleration=5.0)
    carry = rt.Phase(robot, (0.1, 5), rt.State(q=HOME, v=0), rt.State(v=0), rt.Duration(), rows, limits=slow)
    solution = rt.plan(carry)
    dense = solution.at(np.linspace(0.0, solution.duration, 4001)).q
    assert max(map(tilt, dense)) < PLANNED * (1.0 + 1e-3)

    times = np.append(np.arange(0.0, solution.duration - 1e-6, 1.0 / RATE), solution.duration)
    plan, gains = solution.at(times), np.array([solution.gains.at(t) for t in times])
    plant = mujoco_robot(robot)
    plant.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    data, where, limit = mujoco.MjData(plant.model), plant.coordinates, robot.limits.effort
    data.qpos[:], data.qvel[:] = where.qpos(plan.q[0]), where.qvel(plan.q[0], plan.v[0])
    tilts, apart = [], []
    for k, step in enumerate(np.diff(times)):
        q = where.q(data.qpos)
        error = np.concatenate([q - plan.q[k], where.v(q, data.qvel) - plan.v[k]])
        data.qfrc_applied[:] = where.force(q, np.clip(plan.tau[k] - gains[k] @ error, -limit, limit))
        plant.model.opt.timestep = step / SUBSTEPS
        for _ in range(SUBSTEPS):
            mujoco.mj_step(plant.model, data)
            tilts.append(tilt(where.q(data.qpos)))
        apart.append(np.abs(where.q(data.qpos) - plan.q[k + 1]).max())
    assert max(tilts) < ALLOWED
    assert max(apart) < 0.01
