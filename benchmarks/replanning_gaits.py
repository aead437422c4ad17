"""Trots that rt.Replanner plans again in MuJoCo under pushes: python benchmarks/replanning_gaits.py [name ...].

Every 20 ms the whole body is planned from MuJoCo's state, which follows the plan with joint feedback at 1 kHz. Each
half second a force pushes the trunk, from a random side, for 0.1 s. Without arguments the table is written to
replanning_gaits.md. Processor seconds of one thread.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.witness.mujoco.feet import SoftGround, feet_of, furnish
from robotraj.witness.mujoco.model import mujoco_robot
from robotraj.witness.mujoco.reference_motion import ReferenceMotion

PERIOD, STEP, STEPS = 0.02, 1e-3, 100
ROBOTS = {"solo12": (0.06, 0.2, 3.0, 0.08), "go1": (0.08, 0.24, 40.0, 1.5)}
"""Step length [m], duration of a step [s], stiffness and damping of the joints [N m/rad, N m s/rad]."""
PUSHES = (0.0, 0.3, 0.6)
"""Forces, relative to the weight."""
HEAD = (
    "| robot | push / weight | fell | way / planned way | plans that meet their rows | iterations, "
    "median and most | step, median [ms] | 99th percentile [ms] | over 20 ms | making [s] |"
)


class Trot:
    """A robot, its trot and its replanner."""

    def __init__(self, name: str) -> None:
        length, duration, self.stiffness, self.damping = ROBOTS[name]
        self.robot = rt.load(name, root="floating")
        feet = tuple(each for each in rt.gait.limb_ends(self.robot) if each.lower().endswith("foot"))
        contact = rt.PointContact(feet[0], friction=0.7)
        problem = rt.gait.trot(self.robot, step_length=length, duration=duration, feet=feet, contact=contact)
        self.gait, self.speed = rt.plan(problem, progress=False), length / duration
        began = time.process_time()
        self.replanner = rt.Replanner(problem, guess=self.gait, period=PERIOD)
        self.making = time.process_time() - began

    def driven(self, push: float) -> list[str]:
        """Run one loop; return the cells of its row after the push."""
        course = ReferenceMotion(self.gait, 2)
        plant = mujoco_robot(self.robot, None, partial(furnish, course, feet_of(course), SoftGround()))
        plant.model.opt.timestep, plant.model.opt.impratio = STEP, 10.0
        plant.model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        data, coordinates, first = mujoco.MjData(plant.model), plant.coordinates, self.gait.at(0.0)
        data.qpos[:], data.qvel[:] = coordinates.qpos(first.q), coordinates.qvel(first.q, first.v)
        motors, most = np.asarray(self.robot.actuation, dtype=float), self.robot.limits.effort_upper[6:]
        force, angle = push * 9.81 * pin.computeTotalMass(self.robot.model), 0.0
        sides, fresh = np.random.default_rng(0), 0
        seconds: list[float] = []
        iterations: list[int] = []
        for k in range(STEPS):
            t, q = k * PERIOD, coordinates.q(data.qpos)
            began = time.process_time()
            replan = self.replanner.step(t, rt.State(q=q, v=coordinates.v(q, data.qvel)))
            seconds.append(time.process_time() - began)
            iterations.append(replan.iterations)
            fresh += replan.fresh
            if k % 25 == 0:
                angle = sides.uniform(0.0, 2.0 * np.pi)
            pushed = force * np.array([np.cos(angle), np.sin(angle)]) * (10 <= k % 25 < 15)
            for i in range(round(PERIOD / STEP)):
                plan, q = replan.at(t + STEP * (i + 0.5)), coordinates.q(data.qpos)
                v = coordinates.v(q, data.qvel)
                tau = plan.tau + self.stiffness * (plan.q[7:] - q[7:]) + self.damping * (plan.v[6:] - v[6:])
                data.xfrc_applied[1, :2] = pushed
                data.qfrc_applied[:] = coordinates.force(q, motors @ np.clip(tau, -most, most))
                mujoco.mj_step(plant.model, data)
            if data.qpos[2] < 0.5 * first.q[2]:
                break
        ms = 1e3 * np.array(seconds)
        return [
            "no" if k == STEPS - 1 else f"at {k * PERIOD:.2f} s",
            f"{data.qpos[0] / (self.speed * PERIOD * (k + 1)):.2f}",
            f"{fresh} of {k + 1}",
            f"{np.median(iterations):g}, {max(iterations)}",
            f"{np.median(ms):.1f}",
            f"{np.percentile(ms, 99):.1f}",
            f"{100.0 * np.mean(ms > 1e3 * PERIOD):.0f} %",
            f"{self.making:.1f}",
        ]


def main() -> None:
    """Run every loop, and write the table of all robots."""
    rows = []
    for name in sys.argv[1:] or ROBOTS:
        trot = Trot(name)
        for push in PUSHES:
            rows.append(f"| {name} | {push:g} | {' | '.join(trot.driven(push))} |")
            print(rows[-1], flush=True)
    if not sys.argv[1:]:
        rule = "|" + "---|" * HEAD.count(" | ") + "---|"
        text = "\n".join(["# Trots planned again", "", *__doc__.splitlines()[2:], "", HEAD, rule, *rows, ""])
        Path(__file__).with_suffix(".md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
