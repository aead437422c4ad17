"""A ur5 in MuJoCo, replanned every 20 ms towards a goal that moves, around an obstacle that moves."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

PERIOD, STEP = 0.02, 1e-3
START = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
RADIUS = 0.15


def goal(t):
    """Goal at time t [rad]."""
    still = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
    return still + 0.1 * np.sin(2.0 * t) * np.array([1.0, -0.5, 0.5, 0.0, 0.0, 1.0])


def obstacle(t, sin=np.sin):
    """Centre of a ball at time t [m]; the tool's shortest path passes through it."""
    return [0.7 + 0.03 * sin(3.0 * t), 0.2, 0.42]


@pytest.mark.slow
def test_the_tool_stays_clear_and_follows_a_moving_goal():
    mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    from robotraj.witness.mujoco.model import mujoco_robot

    ur5 = rt.load("ur5")
    names = [f"goal.{i}" for i in range(6)]

    def distance(point):
        return sum((point.q[i] - point.p[name]) ** 2 for i, name in enumerate(names))

    clear = rt.PathConstraint(
        lambda point: ca.norm_2(point.frame("tool0").position - ca.vertcat(*obstacle(point.t, ca.sin))),
        lower=RADIUS,
        name="clearance",
        unit="m",
    )
    reach = rt.Phase(
        ur5,
        duration=1.0,
        start=rt.State(q=START, v=0),
        end=rt.State(v=0),
        objective=rt.Lagrange(distance) + 1e-5 * rt.Effort(),
        constraints=[clear],
        parameters=dict(zip(names, goal(0.0), strict=True)),
    )
    replanner = rt.Replanner(reach, mesh=rt.Mesh(20))
    plant = mujoco_robot(ur5).model
    plant.opt.timestep = STEP
    data = mujoco.MjData(plant)
    data.qpos[:] = START
    gains = np.array([100.0, 100.0, 100.0, 20.0, 20.0, 20.0])
    model, frames = ur5.model, ur5.model.createData()
    kept, distances, errors = 0, [], []
    for k in range(125):
        t = k * PERIOD
        start = rt.State(q=data.qpos.copy(), v=data.qvel.copy())
        replan = replanner.step(t, start, parameters=dict(zip(names, goal(t), strict=True)))
        kept += not replan.fresh
        plan = replan.at(t + STEP * np.arange(int(PERIOD / STEP)))
        for q, v, tau in zip(plan.q, plan.v, plan.tau, strict=True):
            data.qfrc_applied[:] = tau + gains * (q - data.qpos) + 0.2 * gains * (v - data.qvel)
            mujoco.mj_step(plant, data)
            pin.framesForwardKinematics(model, frames, data.qpos.copy())
            tool = frames.oMf[model.getFrameId("tool0")].translation
            distances.append(float(np.linalg.norm(tool - obstacle(data.time))))
        errors.append(float(np.max(np.abs(data.qpos - goal(t + PERIOD)))))
    assert kept == 0
    assert min(distances) > RADIUS - 2e-3
    assert min(distances) < RADIUS + 2e-2  # the obstacle is in the way
    assert errors[0] > 2.0
    assert max(errors[-25:]) < 0.1
