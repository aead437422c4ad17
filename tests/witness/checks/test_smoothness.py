"""Teeth of controls, read from the plan's own curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.checks.smoothness import teeth_of


@pytest.fixture(scope="module")
def with_teeth() -> rt.Solution:
    """A least time in which four joints may wait for the base, and nothing keeps their torques from alternating."""
    ends = ([side, -1.8, 1.6, -1.2, -1.57, 0.0] for side in (-1.1, 1.1))
    post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47))
    states = (rt.State(q=q, v=0) for q in ends)
    phase = rt.Phase(rt.load("ur5"), (0.2, 5.0), *states, rt.Duration(), [rt.CollisionFree([post], margin=0.01)])
    return rt.plan(phase, smoothing=0.0)


def smoothness(solution: rt.Solution) -> rt.witness.Claim:
    return next(claim for claim in rt.validate(solution).claims if claim.name == "smoothness")


def test_the_witness_reads_the_teeth_that_the_planner_measures(with_teeth: rt.Solution) -> None:
    found = teeth_of(with_teeth.phases)
    assert found is not None and with_teeth.proof is not None
    assert found.relative == pytest.approx(with_teeth.proof.roughness, rel=1e-6)
    assert found.relative > 0.1


def test_a_proof_that_claims_no_teeth_is_noticed(with_teeth: rt.Solution) -> None:
    assert with_teeth.proof is not None and not with_teeth.proof.holds
    lie = replace(with_teeth, proof=replace(with_teeth.proof, roughness=0.0))
    assert lie.proof is not None and lie.proof.holds
    claim = smoothness(lie)
    assert claim.judgement is Judgement.FAILS and "percent of its limit" in claim.notes[0]
    assert not rt.validate(lie).passed


def test_teeth_on_a_mesh_of_ones_own_are_told_and_not_judged(with_teeth: rt.Solution) -> None:
    claim = smoothness(replace(with_teeth, proof=None))
    assert claim.judgement is Judgement.NOT_JUDGED and "mesh of one's own" in claim.notes[0]


def test_controls_of_systems_are_read_as_well() -> None:
    """Piecewise constant forces switch once; forces without limits have no size to be judged by."""
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    push = rt.Phase(block, 2.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), controls={"u": rt.between(-9.0, 9.0)})
    found = teeth_of(rt.plan(push).phases)
    assert found is not None and found.control == "u" and found.relative < 1e-3
    assert teeth_of(rt.plan(push.with_(controls={})).phases) is None


def test_a_planned_claim_is_made_where_the_witness_makes_one(with_teeth: rt.Solution) -> None:
    planned = {claim.name: claim.judgement for claim in with_teeth.claims}
    assert planned["smoothness"] is Judgement.FAILS
    assert np.isfinite(smoothness(with_teeth).figure or np.nan)
