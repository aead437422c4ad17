"""Plans whose proof holds are right by judges of other descent; the judges notice what is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from joint_phases import JointPhases
from proofs import BETTER, KINDS, WORSE, Tally, optimum

import robotraj as rt


def planned(kind: str, seed: int) -> tuple[rt.Solution, str]:
    phase, judge = KINDS[kind][0](np.random.default_rng([7, seed]))
    solution = rt.plan(phase, check=False, progress=False)
    assert solution.proof.holds
    return solution, judge(solution)


@pytest.mark.parametrize(
    "kind", ["least effort", "least time", "corridor", "quadratic", "other solver", "phases", "other units"]
)
@pytest.mark.parametrize("seed", range(3))
def test_a_proved_plan_has_the_known_optimum(kind: str, seed: int) -> None:
    assert not planned(kind, seed)[1]


def test_a_proved_plan_has_the_torques_of_mujoco() -> None:
    pytest.importorskip("mujoco")
    assert not planned("inverse dynamics", 0)[1]


@pytest.mark.parametrize("limit", [100.0, 2.0])
def test_curves_of_the_phase_plane_meet_at_the_closed_form(limit: float) -> None:
    """A mass of 2 kg falls 1 m by 30 N: sqrt(2 (1 / u + 1 / w)), or 1 / V + V (1 / u + 1 / w) / 2 at the limit V."""
    slow = 1.0 / (15.0 + 9.81) + 1.0 / (15.0 - 9.81)
    known = np.sqrt(2.0 * slow) if limit**2 * slow > 2.0 else 1.0 / limit + 0.5 * limit * slow
    one, still = np.array([0.0]), np.zeros(2)
    rail = JointPhases(False, 2.0, 0.0, 2.0, np.array([-30.0, 30.0]), limit, 0.0, one, np.array([1.0, 0.0]), still)
    assert rail.optimum == pytest.approx(known, rel=1e-9)


@pytest.mark.parametrize("factor", [1.0 - 2.0 * BETTER, 1.0 + 2.0 * WORSE, np.nan])
def test_a_judge_notices_another_optimum(factor: float) -> None:
    solution, _ = planned("least effort", 0)
    known = solution.objective
    assert not optimum(known)(solution)
    assert optimum(known)(replace(solution, objective=factor * known))


def test_judges_of_motions_notice_lies() -> None:
    pytest.importorskip("mujoco")
    phase, judge = KINDS["inverse dynamics"][0](np.random.default_rng([7, 0]))
    solution = rt.plan(phase.with_(duration=3.5), mesh=rt.Mesh(40), check=False, progress=False)
    assert not judge(solution)

    class Heavier:
        duration = solution.duration

        def at(self, t: np.ndarray) -> object:
            sample = solution.at(t)
            return replace(sample, tau=1.1 * sample.tau)

    assert "torques differ" in judge(Heavier())


def test_a_tally_counts_what_was_drawn() -> None:
    tally = Tally()
    for seed in range(4):
        tally.attempt(seed)
    assert 1 <= sum(tally.proved.values()) <= sum(tally.drawn.values()) <= 4
    assert str(tally).endswith("proved plans are wrong (0 %)") and not tally.wrong
