"""The first state of a phase follows from the last one of the phase before, by the rows of their link."""

from types import SimpleNamespace

import numpy as np
import pytest

import robotraj as rt
import robotraj.witness.simulation.open_loop as simulation
from robotraj.witness.simulation.integration import integrate
from robotraj.witness.simulation.open_loop import handed_on
from robotraj.witness.simulation.runge_kutta import NODES, STAGES, stage_times
from robotraj.witness.simulation.spans import Span

NAMES = ("q.hip", "q.knee", "v.hip", "v.knee")
REACHED, PLANNED, OWN = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.9, 2.1, 3.3, 4.0]), np.array([0.9, 2.5, -1.0, 0.5])
EVERY = [("continuity", name) for name in NAMES]


def first_state(*rows: tuple[str, str]) -> np.ndarray:
    links = [SimpleNamespace(phases=(0, 1), rows=[SimpleNamespace(name=name, joint=joint) for name, joint in rows])]
    solution = SimpleNamespace(problem=SimpleNamespace(bound_links=links if rows else []))
    plant = SimpleNamespace(names=NAMES)
    return np.asarray(handed_on(solution, 1, plant, OWN, (plant, REACHED, PLANNED)))


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ((), REACHED),  # phases that no link joins
        ((("continuity", "time"), *EVERY), REACHED),
        # States that jump take the jump of the plan.
        ((("continuity", "time"), *EVERY[:2], ("jump", "v.hip")), REACHED + [0, 0, *(OWN - PLANNED)[2:]]),
        # A link of other things alone: every state takes its jump.
        ((("equal parameter", "mass"),), REACHED + OWN - PLANNED),
        # The plant computes the impact from the velocities before it.
        ((("continuity", "time"), *EVERY[:2], ("impact", "v.hip")), REACHED),
        ((("continuity", "time"), EVERY[0], ("impact", "v.hip")), REACHED + [0, (OWN - PLANNED)[1], 0, 0]),
        # A gait is repeated: the end of its period is no earlier moment.
        ((*EVERY[:2], ("impact", "v.hip")), OWN),
    ],
)
def test_the_first_state_of_a_phase(rows: tuple[tuple[str, str], ...], expected: np.ndarray) -> None:
    np.testing.assert_allclose(first_state(*rows), expected, atol=1e-15)


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_the_plan_is_sampled_at_the_stages_of_equal_steps(steps: int) -> None:
    times = stage_times(Span(2.0, 4.0, 0), steps)
    length = 2.0 / steps
    expected = [2.0 + length * (step + node) for step in range(steps) for node in NODES] + [4.0]
    assert len(times) == STAGES * steps + 1
    np.testing.assert_allclose(times, expected, atol=1e-6)
    assert times.min() > 2.0 and times.max() < 4.0


@pytest.mark.parametrize(
    ("x", "rate"), [([1.0, np.nan], [0.0, 0.0]), ([1.0, 0.0], [0.0, np.nan]), ([np.inf, 0.0], [np.inf, 0.0])]
)
def test_a_state_or_a_rate_that_is_no_number_ends_the_integration_at_once(x: list[float], rate: list[float]) -> None:
    motion = integrate(lambda t, state, k: np.array(rate), np.array(x), np.array([0.5, 1.0]))
    assert motion.failure == "the state or its rates are not finite" and motion.stopped == 0.5


def test_the_simulation_ends_where_a_robot_has_fallen() -> None:
    biped = rt.load("five_link", root="planar")
    standing = rt.gait.stand(biped)
    feet = [rt.PointContact("left_foot"), rt.PointContact("right_foot")]
    lean = rt.Phase(biped, 3.0, rt.State(q=standing, v=0), rt.State(v=0), rt.Effort(), contacts=feet)
    report = rt.validate(rt.plan(lean, rt.Mesh(12)))
    assert report.failure is not None and "the robot has fallen, q." in report.failure
    assert 0.0 < report.drift.worst.time < 3.0
    assert not any("open-loop" in failure for failure in report.failures(report.tolerances))


def test_the_simulation_ends_where_an_arm_has_left_its_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation, "LOST", 1e-9)
    arm = rt.load("double_pendulum")
    ends = rt.State(q=[np.pi, 0.0], v=0), rt.State(q=[np.pi + 0.3, -0.3], v=0)
    report = rt.validate(rt.plan(rt.Phase(arm, 6.0, *ends, rt.Effort(), limits=None), rt.Mesh(6)))
    assert report.failure is not None and "the motion has left the plan, q." in report.failure
    assert report.drift.worst.time < 6.0
