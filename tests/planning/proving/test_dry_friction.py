"""Least times of axes with dry friction are those of Coulomb's law, not of the smooth law of the equations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.loop import state
from robotraj.planning.proving import sharp_friction
from robotraj.transcription.interval_limits import full_friction

GRAVITY = 9.81
URDF = """<robot name="axis"><link name="base"/><link name="mass"><inertial><mass value="{mass}"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="mass"/><axis xyz="{axis}"/>
<dynamics damping="0" friction="{friction}"/>
<limit lower="-5" upper="5" velocity="{speed}" effort="{force}"/></joint></robot>"""


@dataclass(frozen=True)
class Axis:
    """A mass [kg] on a slide with dry friction [N], within a force [N] and a speed [m/s]."""

    mass: float
    friction: float
    force: float
    speed: float
    vertical: bool

    @property
    def weight(self) -> float:
        return self.mass * GRAVITY if self.vertical else 0.0

    def robot(self, folder) -> rt.Robot:  # type: ignore[no-untyped-def]
        path = folder / "axis.urdf"
        given = {"mass": self.mass, "friction": self.friction, "force": self.force, "speed": self.speed}
        path.write_text(URDF.format(axis="0 0 1" if self.vertical else "1 0 0", **given))
        return rt.load(path)

    def least_time(self, distance: float) -> float:
        """Time from rest to rest by Coulomb's law: friction opposes the start and helps to stop [s]."""
        along = np.sign(distance) * self.weight
        faster, slower = (self.force - self.friction - along), (self.force + self.friction + along)
        inverse = self.mass * (1 / faster + 1 / slower)
        peak = min(np.sqrt(2 * abs(distance) / inverse), self.speed)
        return float(peak * inverse + (abs(distance) - 0.5 * peak**2 * inverse) / peak)


LIFTS = [
    (Axis(2.0, 4.0, 30.0, 3.0, True), [0.0, 0.2]),
    (Axis(2.0, 8.0, 30.0, 3.0, True), [0.0, 0.2]),
    (Axis(2.0, 8.0, 30.0, 0.25, True), [0.0, 0.2]),
    (Axis(1.0, 6.0, 20.0, 2.0, False), [0.0, 0.7, 0.1]),
]


def drawn(seed: int) -> tuple[Axis, list[float]]:
    rng = np.random.default_rng(seed)
    vertical, mass, share = bool(rng.random() < 0.5), rng.uniform(0.5, 4.0), rng.uniform(0.05, 0.35)
    force = mass * GRAVITY * rng.uniform(2.0, 4.0)
    axis = Axis(float(mass), float(share * force), float(force), float(rng.uniform(0.5, 3.0)), vertical)
    return axis, np.cumsum(np.append(0.0, rng.choice([-1, 1], 2) * rng.uniform(0.2, 1.5, 2))).tolist()


@pytest.mark.parametrize(
    ("axis", "stops"), [*LIFTS, *(pytest.param(*drawn(seed), marks=pytest.mark.slow) for seed in range(8))]
)
def test_least_times_with_dry_friction_are_possible_by_coulombs_law(axis: Axis, stops: list[float], tmp_path) -> None:  # type: ignore[no-untyped-def]
    robot = axis.robot(tmp_path)
    phases = [
        rt.Phase(robot, (0.01, 20), rt.State(q=[a], v=0), rt.State(q=[b], v=0), rt.Duration())
        for a, b in pairwise(stops)
    ]
    solution = rt.plan(rt.Problem(phases, [rt.Continuity(k, k + 1) for k in range(len(phases) - 1)]))
    assert solution.proof is not None and solution.proof.holds
    widths = [part.phase.robot.friction_speed for part in solution.phases if part.phase.robot is not None]
    assert max(widths) <= robot.friction_speed
    least = sum(axis.least_time(b - a) for a, b in pairwise(stops))
    report = rt.validate(solution, drift=None)
    assert report.passed, report.failures(report.tolerances)
    assert least * (1 - 5e-4) <= solution.duration <= least * (1 + 4e-3)
    for part in solution.phases:
        times = np.linspace(part.t0, part.t0 + part.duration, 5001)[1:-1]
        sample = part.at(times)
        force = axis.mass * sample.a[:, 0] + axis.weight + axis.friction * np.sign(sample.v[:, 0])
        assert np.max(np.abs(force)) <= axis.force * (1 + 2e-3)


def test_a_joint_that_rests_is_not_limited_by_its_friction(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """The shoulder's weight and its whole friction exceed its motor, which holds it all the same."""
    arm = rt.load("two_link_arm")
    slow = replace(arm, friction=np.array([0.6, 0.2]))
    ends = rt.State(q=[0.0, 0.0], v=0), rt.State(q=[0.0, 0.4], v=0)
    solution = rt.plan(rt.Phase(slow, (0.05, 10), *ends, rt.Duration(), limits=slow.limits.with_(effort=1.0)))
    assert solution.proof is not None and solution.proof.motion_holds


def test_the_witness_notices_a_start_that_the_smooth_friction_alone_allows(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:  # type: ignore[no-untyped-def]
    for module in (full_friction, state):
        monkeypatch.setattr(module, "has_full_friction", lambda phase: False)
    monkeypatch.setattr(sharp_friction, "FRICTION", np.inf)
    axis, (start, end) = LIFTS[0]
    ends = rt.State(q=[start], v=0), rt.State(q=[end], v=0)
    wide = replace(axis.robot(tmp_path), friction_speed=0.05)
    solution = rt.plan(rt.Phase(wide, (0.01, 20), *ends, rt.Duration()))
    assert solution.proof is not None and solution.proof.holds
    assert solution.duration < axis.least_time(end - start) * (1 - 1e-2)
    report = rt.validate(solution, drift=None)
    assert [violation.name for violation in report.violations] == ["effort limit against dry friction"]
    assert not report.passed
