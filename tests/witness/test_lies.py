"""Every planted lie about a proved plan is noticed, and the plan itself is not refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.cost.objective import objective_check
from tests.cli.shell import run
from tests.lies import GRIPPER, axis, elsewhere, fed_back, linked, lying, spliced, stored, with_model

Lie = Callable[[rt.Solution], rt.Solution]


def reach(name: str, start: Any, end: Any, seconds: float, apart: bool = True) -> rt.Solution:
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    phase = rt.Phase(rt.load(name), seconds, *ends, rt.Effort(), self_collision=apart)
    return rt.plan(phase, progress=False)


def slide(seconds: float, metres: float, **values: Any) -> rt.Solution:
    robot = axis(Path(mkdtemp()), travel=10.0 * metres, **values)
    phase = rt.Phase(robot, seconds, rt.State(q=0, v=0), rt.State(q=metres, v=0), rt.Effort())
    return rt.plan(phase, progress=False)


def two_phases(shoulder: float = 1.0) -> rt.Solution:
    robot = rt.load("two_link_arm")
    home, away = rt.State(q=[0, 0], v=0), rt.State(q=[shoulder, 0.5], v=0)
    there = rt.Phase(robot, 1.0, home, away, rt.Effort(), name="there", limits=None)
    back = rt.Phase(robot, 1.0, None, home, rt.Effort(), name="back", limits=None)
    return rt.plan(rt.Problem([there, back], [rt.Continuity(0, 1)]), progress=False)


def hop() -> rt.Solution:
    robot = rt.load("hopper", root="planar")
    stand = [rt.PointContact("foot")]
    objective = rt.Effort() + rt.Duration()
    phase = rt.Phase(robot, (0.2, 1.0), rt.State(q={"root_x": 0.0}, v=0), None, objective, contacts=stand)
    return rt.plan(phase, progress=False)


def oscillator() -> rt.Solution:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], -3600 * p.x["x"] + p.u["u"]])
    return rt.plan(rt.Phase(system, 0.3, rt.State([1e-6, 0]), rt.State([0, 0]), rt.Effort()), progress=False)


def gripper(folder: Path, ratio: float) -> rt.Robot:
    """Return a gripper whose right finger moves ``ratio`` times as far as the left one."""
    file = folder / f"gripper_{ratio}.urdf"
    file.write_text(GRIPPER.replace('joint="left_joint"/>', f'joint="left_joint" multiplier="{ratio}"/>'))
    return rt.load(str(file))


PLANS: dict[str, Callable[[], rt.Solution]] = {
    "ur5": lambda: reach("ur5", [0, -1.3, 1.6, -1.9, -1.57, 0], [1, -1, 1.2, -1, -1, 1], 1.0),
    "ur5, 20 s": lambda: reach("ur5", [0, -1.3, 1.6, -1.9, -1.57, 0], [1, -1, 1.2, -1, -1, 1], 20.0, False),
    "crane": lambda: slide(60.0, 5.0, mass=20000),
    "stage": lambda: slide(0.5, 1e-3, mass=0.5),
    "watch": lambda: slide(0.1, 1e-6, mass=1e-6),
    "cartpole": lambda: reach("cartpole", [0, 0], [1, np.pi], 2.0),
    "two phases": two_phases,
    "hopper": hop,
    "oscillator of 1 um": oscillator,
}


@cache
def plan(name: str) -> rt.Solution:
    return PLANS[name]()


def failing(report: Any) -> list[str]:
    return [claim.name for claim in report.claims if claim.judgement is Judgement.FAILS]


def times(share: float, solution: rt.Solution) -> float:
    return share * solution.duration


def bump(solution: rt.Solution) -> Callable[[Any, Any], Any]:
    """A bump of a hundredth of the motion, a fiftieth of its time long."""
    T = solution.duration
    q = solution.at(np.linspace(0, T, 200)).q
    height = 1e-2 * np.ptp(q, axis=0).max()
    return lambda t, x: x + height * np.exp(-(((t - 0.43 * T) / (T / 100)) ** 2))


def later(solution: rt.Solution) -> rt.Solution:
    """The torques of a fiftieth of the motion before."""
    T = solution.duration
    return lying(solution, tau=lambda t, x: solution.at(np.clip(t[..., 0] - 0.02 * T, 0.0, T)).tau)


ROBOT_LIES: dict[str, Lie] = {
    "torques 2 percent too large": lambda s: lying(s, tau=lambda t, x: 1.02 * x),
    "torques 2 percent too small": lambda s: lying(s, tau=lambda t, x: 0.98 * x),
    "no torques": lambda s: lying(s, tau=lambda t, x: 0 * x),
    "reversed torques": lambda s: lying(s, tau=lambda t, x: -x),
    "delayed torques": later,
    "speeds 2 percent too large": lambda s: lying(s, v=lambda t, x: 1.02 * x),
    "a bump of the positions": lambda s: lying(s, q=bump(s)),
    "positions in degrees": lambda s: lying(s, q=lambda t, x: np.rad2deg(x)),
    "an objective 1 percent too small": lambda s: replace(s, objective=0.99 * s.objective),
}
MODEL_LIES: dict[str, Lie] = {
    "masses 5 percent larger": lambda s: elsewhere(s, lambda p: with_model(p, heavier)),
    "rotors left out": lambda s: elsewhere(s, lambda p: with_model(p, geared)),
    "ends elsewhere": lambda s: elsewhere(s, other_end),
}


def geared(model: Any) -> None:
    """Add rotors whose armature is a twentieth of the mass that the first joint moves."""
    model.armature[:] += 0.05 * sum(body.mass for body in model.inertias.tolist()[1:])


def heavier(model: Any) -> None:
    for i in range(1, model.njoints):
        model.inertias[i].mass *= 1.05
        model.inertias[i].inertia = 1.05 * model.inertias[i].inertia


def other_end(phase: rt.Phase) -> rt.Phase:
    """Require an end that is a twentieth of the way away."""
    if phase.end is None:
        return phase
    q = np.array([bound for bound in phase.joint_ends[rt.constraints.Where.END].lower[: phase.robot.nq]])
    return replace(phase, end=rt.State(q=q + 0.05 * max(np.ptp(q), np.abs(q).max()), v=0))


ROBOTS = ("ur5", "ur5, 20 s", "crane", "stage", "watch", "cartpole", "two phases")
QUICK = ("crane", "stage")
STIFF = ("ur5, 20 s", "two phases")
"""Plans whose feedback is stiff in degrees: its simulation takes up to 40 s, and judges the same as that of ur5."""
CASES = [
    pytest.param(name, lie, marks=[] if name in QUICK else [pytest.mark.slow])
    for name in ROBOTS
    for lie in (*ROBOT_LIES, *MODEL_LIES)
    if not (lie == "positions in degrees" and name in STIFF)
]


@pytest.mark.parametrize("name", PLANS)
def test_the_plan_itself_is_not_refused(name: str) -> None:
    report = rt.validate(plan(name))
    assert report.passed, report.failures(report.tolerances)


@pytest.mark.parametrize(("name", "lie"), CASES)
def test_a_lie_about_a_robot_is_noticed(name: str, lie: str) -> None:
    told = (ROBOT_LIES | MODEL_LIES)[lie](plan(name))
    assert not rt.validate(told).passed


@pytest.mark.parametrize("share", [0.0, 0.5, 0.98])
def test_wrong_contact_forces_are_noticed(share: float) -> None:
    assert not rt.validate(lying(plan("hopper"), forces=lambda t, x: share * x)).passed


def test_swapped_joints_and_another_gravity_are_noticed() -> None:
    arm = plan("ur5")
    assert not rt.validate(lying(arm, tau=lambda t, x: x[..., [1, 0, 2, 3, 4, 5]])).passed

    def on_the_moon(model: Any) -> None:
        model.gravity.linear = np.array([0, 0, -1.62])

    assert not rt.validate(elsewhere(arm, lambda p: with_model(p, on_the_moon))).passed


def test_a_limit_that_was_lowered_is_noticed() -> None:
    arm = plan("ur5")
    peak = np.abs(arm.at(np.linspace(0, 1, 500)).v).max(axis=0)[0]
    limits = arm.phases[0].robot.limits.with_(velocity={"shoulder_pan_joint": 0.98 * peak})
    assert not rt.validate(elsewhere(arm, lambda p: replace(p, limits=limits))).passed


@pytest.mark.parametrize("factor", [0.9, 1.02, -1.0, 0.0])
def test_wrong_controls_of_a_small_system_are_noticed(factor: float) -> None:
    assert not rt.validate(lying(plan("oscillator of 1 um"), u=lambda t, x: factor * x)).passed


def test_a_state_of_a_system_that_is_wrong_between_two_knots_is_noticed() -> None:
    """By two percent, in the middle of one interval alone, where no window of the simulation ends."""
    solution = plan("oscillator of 1 um")
    begin, end = solution.knots[len(solution.knots) // 2 :][:2]
    peak = np.abs(solution.at(solution.knots).x["x"]).max()

    def shaken(t: Any, x: Any) -> Any:
        return x + 0.02 * peak * np.exp(-(((t - 0.5 * (begin + end)) / (0.2 * (end - begin))) ** 2))

    assert not rt.validate(lying(solution, x=shaken)).passed


@pytest.mark.parametrize(("name", "which"), [*product(QUICK, "xzu"), ("hopper", "x"), ("hopper", "z")])
def test_what_a_plan_stores_is_that_of_its_motion(name: str, which: str) -> None:
    """States, accelerations, contact forces and torques at the collocation points, each two percent too large."""
    assert not rt.validate(stored(plan(name), which, lambda values: 1.02 * values)).passed


@pytest.mark.parametrize("bounds", [(0.0102, 0.0102), (0.0102, 200.0)])
def test_another_duration_is_noticed_however_short_it_is(bounds: tuple[float, float]) -> None:
    """Two percent of 10 ms are 2e-4 s, and a millionth of what the bounds let it be."""
    solution = slide(0.01, 1e-6, mass=1.0)
    assert rt.validate(solution).passed
    assert not rt.validate(elsewhere(solution, lambda phase: phase.with_(duration=bounds))).passed


def test_the_claims_name_their_judges_and_what_they_leave_out() -> None:
    report = rt.validate(plan("ur5"))
    assert [claim.name for claim in report.claims] == [claim.name for claim in plan("ur5").claims]
    for claim in report.claims:
        assert claim.judge and claim.covers and claim.leaves_out


@pytest.mark.parametrize("field", ["tau", "q", "v"])
def test_samples_that_are_not_numbers_are_noticed(field: str) -> None:
    """In the middle fifth of the motion; a comparison with a value that is not a number is false."""
    solution = plan("stage")
    middle = 0.4 * solution.duration, 0.6 * solution.duration
    told = lying(solution, **{field: lambda t, x: np.where((t > middle[0]) & (t < middle[1]), np.nan, x)})
    assert not rt.validate(told).passed


def test_links_that_the_motion_does_not_keep_are_noticed() -> None:
    """The second phase of another plan, a motion that does not repeat, and one that repeats by another angle."""
    solution, other = two_phases(), two_phases(1.02)
    told = replace(spliced(solution, other, 1), objective=0.5 * (solution.objective + other.objective))
    assert any(breach.name == "continuity" for breach in rt.validate(told).breaches)
    joined = rt.Continuity(0, 1)
    assert rt.validate(linked(solution, joined, rt.Periodic())).passed
    assert not rt.validate(linked(solution, joined, rt.Periodic({"q.shoulder": 0.01}))).passed


@pytest.mark.parametrize("ratio", [0.5, 0.98, 1.02])
def test_a_follower_with_another_ratio_is_noticed(tmp_path: Path, ratio: float) -> None:
    ends = [rt.State(q={"lift": lift, "left_joint": opened}, v=0) for lift, opened in ((0, 0), (1, 0.04))]
    solution = rt.plan(rt.Phase(gripper(tmp_path, 1.0), 1.0, *ends, rt.Effort()), progress=False)
    assert rt.validate(solution).passed
    assert not rt.validate(elsewhere(solution, lambda p: replace(p, subject=gripper(tmp_path, ratio)))).passed


@pytest.mark.parametrize(
    "contact",
    [
        rt.PointContact("body", name="foot"),
        rt.PointContact("foot", ground=rt.terrain.Slope(0.1)),
        rt.PointContact("foot", ground=rt.terrain.Flat(0.01)),
        rt.PointContact("foot", offset=(0.0, 0.0, 0.02)),
    ],
    ids=["frame", "slope", "height", "offset"],
)
def test_another_contact_is_noticed(contact: rt.PointContact) -> None:
    assert not rt.validate(elsewhere(plan("hopper"), lambda p: replace(p, contacts=[contact]))).passed


@pytest.mark.parametrize("name", ["stage", "cartpole", "hopper", pytest.param("ur5", marks=pytest.mark.slow)])
@pytest.mark.parametrize("which", ["all", "first", "last"])
def test_reversed_feedback_is_noticed(name: str, which: str) -> None:
    """The simulation starts on the plan, so that wrong feedback has nothing to feed back but rounding."""
    motors = plan(name).phases[0].phase.robot.nu
    factors = {"all": [-1] * motors, "first": [-1] + [1] * (motors - 1), "last": [1] * (motors - 1) + [-1]}
    assert "tracking" in failing(rt.validate(fed_back(plan(name), factors[which])))
    assert "tracking" not in failing(rt.validate(fed_back(plan(name), [0.5] * motors)))


@pytest.mark.parametrize("intervals", [4, 12])
def test_the_proof_of_another_plan_is_noticed(intervals: int) -> None:
    """On a coarse mesh the same problem has another motion, with errors that the copied proof denies."""
    proved = plan("cartpole")
    coarse = rt.plan(proved.problem, rt.Mesh(intervals), progress=False)
    assert not rt.validate(replace(coarse, proof=proved.proof)).passed


def there_and_back(objective: rt.Objective, *seconds: Any, speed: float | None = None) -> rt.Problem:
    """Return two phases of an arm, each with its bounds of the duration, under its own or a lower limit of speed."""
    robot = rt.load("two_link_arm")
    limits = None if speed is None else robot.limits.with_(velocity=speed)
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1.0, 0.5], v=0)
    pairs = zip(seconds, (ends, ends[::-1]), ("there", "back"), strict=True)
    phases = [rt.Phase(robot, each, *own, objective, name=name) for each, own, name in pairs]
    return rt.Problem([phase if limits is None else replace(phase, limits=limits) for phase in phases])


FREE = (0.1, 20.0)


@cache
def fastest() -> rt.Solution:
    return rt.plan(there_and_back(rt.Duration(), FREE, FREE), progress=False)


@cache
def quick_and_calm() -> rt.Solution:
    return rt.plan(there_and_back(rt.Duration() + 0.01 * rt.Effort(), FREE, FREE), progress=False)


def worse(motion: rt.Solution, optimal: rt.Solution) -> rt.Solution:
    """Return a motion as if it answered the problem of an optimal one, with its proof and with its own cost."""
    phases = iter(optimal.problem.phases)
    told = elsewhere(motion, lambda _: next(phases))
    return replace(told, objective=objective_check(told).of_motion, proof=optimal.proof, status=optimal.status)


def stopped_early() -> rt.Solution:
    """Return a motion whose rows hold, before the solver converged."""
    solver = rt.InteriorPoint(max_iterations=4, fallback=None)
    mesh = tuple(part.mesh for part in quick_and_calm().phases)
    problem = quick_and_calm().problem
    return rt.plan(problem, mesh, fastest(), solver, check=False, progress=False, restarts=rt.planning.Restarts(0))


WORSE: dict[str, Callable[[], rt.Solution]] = {
    "both phases 10 percent slower": lambda: worse(
        rt.plan(there_and_back(rt.Effort(), *(1.1 * p.duration for p in fastest().phases)), progress=False), fastest()
    ),
    "one phase 2 percent slower": lambda: worse(
        rt.plan(there_and_back(rt.Duration(), FREE, (1.02 * fastest().phases[1].duration, 20.0)), progress=False),
        fastest(),
    ),
    "a lower limit": lambda: worse(
        rt.plan(there_and_back(rt.Duration(), FREE, FREE, speed=0.8), progress=False), fastest()
    ),
    "another weight": lambda: worse(
        rt.plan(there_and_back(rt.Duration() + 0.1 * rt.Effort(), FREE, FREE), progress=False), quick_and_calm()
    ),
    "another objective": lambda: worse(
        rt.plan(there_and_back(rt.Duration() + 0.3 * rt.Effort(), FREE, FREE), progress=False), fastest()
    ),
    "a solver that stopped early": lambda: worse(stopped_early(), quick_and_calm()),
}


@pytest.mark.parametrize("name", WORSE)
def test_a_worse_motion_with_the_proof_of_an_optimum_is_noticed(name: str) -> None:
    """Everything else about the motion is true. Torques of a solver that stopped early alternate as well."""
    others = ["smoothness"] if name == "a solver that stopped early" else []
    assert failing(rt.validate(WORSE[name]())) == [*others, "optimum"]


@pytest.mark.parametrize("optimal", [fastest, quick_and_calm])
def test_the_optimum_itself_is_not_refused(optimal: Callable[[], rt.Solution]) -> None:
    assert all(claim.holds for claim in rt.validate(optimal()).claims if claim.name == "optimum")


SAVED: dict[str, tuple[str, Lie]] = {
    "torques": ("torques", lambda s: stored(s, "u", lambda values: 1.02 * values)),
    "model": ("torques", MODEL_LIES["masses 5 percent larger"]),
    "objective": ("objective", ROBOT_LIES["an objective 1 percent too small"]),
}


@pytest.mark.parametrize("lie", [None, *SAVED])
def test_the_shell_notices_lies_in_a_file(tmp_path: Path, lie: str | None) -> None:
    solution = plan("stage")
    file = (solution if lie is None else SAVED[lie][1](solution)).save(tmp_path / "plan.npz")
    result = run("validate", file, "--json")
    told = json.loads(result.stdout)
    assert (result.exit_code, told["proved"]) == ((0, True) if lie is None else (4, False)), told
    failed = {claim["name"] for claim in told["claims"] if claim["judgement"] == "fails"}
    assert failed == set() if lie is None else SAVED[lie][0] in failed
    assert bool(told["failures"]) is (lie is not None)
