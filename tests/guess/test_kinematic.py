"""Kinematic plans: all rows but torque limits hold at the guess, if all joints have motors."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.planning.kinematic import kinematic_phase

MESH = rt.Mesh(10)


def reach(**changes: object) -> rt.Phase:
    ur5 = rt.load("ur5")
    given = dict(
        duration=(0.5, 6.0),
        start=rt.State(q=[0, -1, 1, 0, 1, 0], v=0),
        end=rt.State(v=0),
        objective=rt.Effort() + rt.Duration(),
        constraints=[
            rt.AtEnd(rt.FramePosition("tool0", [0.4, 0.3, 0.5])),
            rt.GroundClearance("tool0", 0.3),
            rt.PathConstraint(lambda point: point.tau[1], -60, 60, name="shoulder torque"),
        ],
    )
    return rt.Phase(ur5, **(given | changes))


def broken(problem: rt.Problem, guess: rt.planning.Kinematic) -> dict[str, float]:
    """Largest violation of each kind of row at the guess."""
    nlp = rt.transcription.transcribe(problem, MESH, guess)
    values = nlp.values(nlp.guess)
    amount = np.maximum(np.maximum(nlp.rows.lower - values, values - nlp.rows.upper), 0.0)
    found: dict[str, float] = {}
    for number, entry in enumerate(nlp.rows.entries):
        chosen = amount[nlp.rows.meaning == number]
        if chosen.size:
            found[entry.name] = max(found.get(entry.name, 0.0), float(chosen.max()))
    return found


def test_all_rows_but_torque_limits_hold_at_the_guess() -> None:
    found = broken(rt.Problem([reach()]), rt.planning.Kinematic(MESH))
    torque = found.pop("shoulder torque")
    assert {"defect", "torque balance", "ground clearance", "frame position x"} <= set(found)
    assert max(found.values()) < 1e-5, found
    assert torque >= 0.0


def test_links_hold_at_the_guess() -> None:
    first = reach(duration=2.0, name="out", constraints=[rt.AtEnd(rt.FramePosition("tool0", [0.4, 0.3, 0.5]))])
    back = reach(duration=1.5, start=None, end=rt.State(q=[0, -1, 1, 0, 1, 0], v=0), name="back", constraints=[])
    found = broken(rt.Problem([first, back], [rt.Continuity(0, 1)]), rt.planning.Kinematic(MESH))
    assert max(found.values()) < 1e-5, found


def test_what_depends_on_torques_is_dropped_and_the_rest_kept() -> None:
    phase = kinematic_phase(reach(controls={"tau.elbow_joint": rt.between(-5, 5)}))
    rows = {row.name for constraint in phase.bound_constraints for row in constraint.rows}
    assert {"position limit", "velocity limit", "ground clearance", "frame position x"} <= rows
    assert not {"effort limit", "control bound", "shoulder torque"} & rows
    assert [c.name for c in phase.dae.controls] == [f"a.{joint}" for joint in phase.robot.joint_names]


def test_a_free_duration_is_the_guessed_one_without_limits() -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(
        arm,
        duration=(0.1, 50.0),
        start=rt.State(q=0, v=0),
        end=rt.State(q=[1.0, 0.5], v=0),
        limits=None,
        objective=rt.Duration(),
    )
    known = rt.planning.Kinematic(MESH, duration=3.0).of(phase, 0)
    assert known.duration == pytest.approx(3.0, rel=1e-4)


def test_it_starts_a_plan() -> None:
    solution = rt.plan(reach(), mesh=MESH, guess=rt.planning.Kinematic())
    assert solution.success


def test_a_kinematic_plan_that_fails_warns_and_is_used() -> None:
    # The tip would have to be in a place out of reach.
    places = [rt.AtEnd(rt.PathConstraint(lambda point: point.frame("tool0").position[0], 2.0, 2.0))]
    with pytest.warns(UserWarning, match="kinematic plan failed"):
        known = rt.planning.Kinematic(MESH, solver=rt.Ipopt(max_iterations=50)).of(reach(constraints=places), 0)
    assert np.all(np.isfinite(known.states(np.linspace(0, 1, 5))))


def test_systems_are_refused() -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    with pytest.raises(InputError, match="needs robots"):
        rt.planning.Kinematic().of(rt.Phase(system, duration=1.0), 0)
