"""A walk by Crocoddyl's own example: with its costs, weights, contacts, impulses and solver as published."""

from __future__ import annotations

import resource
import sys
import time

import crocoddyl
import example_robot_data
import numpy as np
import pinocchio as pin
from crocoddyl.utils.biped import SimpleBipedGaitProblem
from crocoddyl.utils.quadruped import SimpleQuadrupedalGaitProblem
from walks import WALKS

SAMPLES = 9


def main() -> None:
    """Solve and write samples of the plan."""
    walk = WALKS[sys.argv[1]]
    model = example_robot_data.load(walk.robot).model
    x0 = np.r_[model.referenceConfigurations[walk.posture], np.zeros(model.nv)]
    if walk.sole is None:
        gait = SimpleQuadrupedalGaitProblem(model, *walk.feet)
        create = gait.createWalkingProblem if walk.title.endswith("walk") else gait.createTrottingProblem
    else:
        gait = SimpleBipedGaitProblem(model, walk.feet[1], walk.feet[0])
        create = gait.createWalkingProblem
    problem = create(x0, walk.length, walk.height, walk.dt, walk.swing, walk.support)
    # Its wheel uses two threads regardless of OMP_NUM_THREADS, which spin while cores are busy.
    problem.nthreads = 1
    solver = crocoddyl.SolverFDDP(problem)
    xs, us = [x0] * (problem.T + 1), problem.quasiStatic([x0] * problem.T)
    began, worked = time.perf_counter(), time.process_time()
    success = solver.solve(xs, us, 100, False)
    figures = {
        "solve": time.perf_counter() - began,
        "worked": time.process_time() - worked,
        "success": success,
        "iterations": solver.iter,
        "nodes": problem.T,
        "objective": solver.cost,
        "ended": time.time(),
        "total worked": time.process_time(),
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    problem.calc(solver.xs, solver.us)
    np.savez(sys.argv[2], **figures, **samples(walk, model, problem, solver))


def samples(walk, model, problem, solver):
    """Each Euler node's straight line: a and tau constant, v linear, q along the velocity at its end."""
    data = model.createData()
    rows = {name: [] for name in ("t", "q", "v", "a", "tau", "force", "stands")}
    t = 0.0
    for action, found, x, u in zip(
        problem.runningModels, problem.runningDatas, list(solver.xs)[:-1], solver.us, strict=True
    ):
        if not hasattr(action, "differential") or action.dt == 0.0:
            continue  # an impulse, whose duration is zero
        q, v, a = x[: model.nq], x[model.nq :], np.array(found.differential.xout)
        s = np.linspace(0.0, action.dt, SAMPLES)
        pin.framesForwardKinematics(model, data, q)
        held = {c.key(): c.data() for c in found.differential.multibody.contacts.contacts}
        force = np.zeros((len(walk.feet), 6))
        for i, foot in enumerate(walk.feet):
            contact = held.get(f"{foot}_contact")
            if contact is not None:
                frame = model.frames[model.getFrameId(foot)]
                local = frame.placement.actInv(contact.fext)
                turn = data.oMf[model.getFrameId(foot)].rotation
                force[i] = np.r_[turn @ local.linear, turn @ local.angular]
        rows["t"].append(t + s)
        rows["q"].append([pin.integrate(model, q, (v + action.dt * a) * r) for r in s])
        rows["v"].append([v + a * r for r in s])
        rows["a"].append([a] * SAMPLES)
        rows["tau"].append([np.array(u)] * SAMPLES)
        rows["force"].append([force] * SAMPLES)
        rows["stands"].append([f"{foot}_contact" in held for foot in walk.feet])
        t += action.dt
    return {name: np.array(value) for name, value in rows.items()}


if __name__ == "__main__":
    main()
