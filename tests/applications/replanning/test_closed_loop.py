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


def driven_in_mujoco(ur5, avoided):
    """Return how many steps kept an earlier plan, q every STEP (m, 6), and the distance from the goal after a step."""
    import mujoco

    from robotraj.witness.mujoco.model import mujoco_robot

    names = [f"goal.{i}" for i in range(6)]

    def distance(point):
        return sum((point.q[i] - point.p[name]) ** 2 for i, name in enumerate(names))

    reach = rt.Phase(
        ur5,
        duration=1.0,
        start=rt.State(q=START, v=0),
        end=rt.State(v=0),
        objective=rt.Lagrange(distance) + 1e-5 * rt.Effort(),
        constraints=[avoided],
        parameters=dict(zip(names, goal(0.0), strict=True)),
    )
    replanner = rt.Replanner(reach, mesh=rt.Mesh(20))
    plant = mujoco_robot(ur5).model
    plant.opt.timestep = STEP
    data = mujoco.MjData(plant)
    data.qpos[:] = START
    gains = np.array([100.0, 100.0, 100.0, 20.0, 20.0, 20.0])
    kept, every, errors = 0, [], []
    for k in range(125):
        t = k * PERIOD
        start = rt.State(q=data.qpos.copy(), v=data.qvel.copy())
        replan = replanner.step(t, start, parameters=dict(zip(names, goal(t), strict=True)))
        kept += not replan.fresh
        plan = replan.at(t + STEP * np.arange(int(PERIOD / STEP)))
        for q, v, tau in zip(plan.q, plan.v, plan.tau, strict=True):
            data.qfrc_applied[:] = tau + gains * (q - data.qpos) + 0.2 * gains * (v - data.qvel)
            mujoco.mj_step(plant, data)
            every.append(data.qpos.copy())
        errors.append(float(np.max(np.abs(data.qpos - goal(t + PERIOD)))))
    return kept, np.array(every), errors


@pytest.mark.slow
def test_the_whole_arm_stays_clear_of_a_ball_and_a_box_and_follows_a_moving_goal():
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    ur5 = rt.load("ur5")
    ball = rt.obstacles.Sphere(0.1, lambda t: obstacle(t, ca.sin), name="ball")
    box = rt.obstacles.Box((0.3, 0.3, 0.4), (-0.5, 0.5, 0.2), name="box")
    avoided = rt.CollisionFree([ball, box], margin=0.01)
    kept, q, errors = driven_in_mujoco(ur5, avoided)
    times = STEP * np.arange(1, len(q) + 1)
    distances = avoided.pairs(ur5).distances(q, times).min(axis=1)
    assert kept == 0
    assert 0.0 < distances.min() < 0.05  # an obstacle blocks the path
    assert errors[0] > 2.0
    assert max(errors[-25:]) < 0.1


@pytest.mark.slow
def test_the_tool_stays_clear_and_follows_a_moving_goal():
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    ur5 = rt.load("ur5")
    clear = rt.PathConstraint(
        lambda point: ca.norm_2(point.frame("tool0").position - ca.vertcat(*obstacle(point.t, ca.sin))),
        lower=RADIUS,
        name="clearance",
        unit="m",
    )
    kept, every, errors = driven_in_mujoco(ur5, clear)
    model, frames, distances = ur5.model, ur5.model.createData(), []
    for k, q in enumerate(every, 1):
        pin.framesForwardKinematics(model, frames, q)
        tool = frames.oMf[model.getFrameId("tool0")].translation
        distances.append(float(np.linalg.norm(tool - obstacle(k * STEP))))
    assert kept == 0
    assert min(distances) > RADIUS - 2e-3
    assert min(distances) < RADIUS + 2e-2  # the obstacle blocks the path
    assert errors[0] > 2.0
    assert max(errors[-25:]) < 0.1
