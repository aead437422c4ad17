"""Scales of the unknowns: variables of joints and contacts with one unit share a scale."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of


@pytest.fixture(scope="module")
def nlp() -> rt.transcription.Nlp:
    robot = rt.load("solo12", root="floating")
    return nlp_of(rt.gait.trot(robot, step_length=0.1, duration=0.25, clearance=0.03), rt.Mesh(4))


def columns(nlp: rt.transcription.Nlp, name: str, unit: str) -> np.ndarray:
    which = [i for i, e in enumerate(nlp.variables.entries) if (e.name, e.unit) == (name, unit)]
    return np.isin(nlp.variables.meaning, which)


@pytest.mark.parametrize(
    ("name", "unit"), [("acceleration", "m/s^2"), ("acceleration", "rad/s^2"), ("contact force", "N")]
)
def test_unbounded_quantities_of_one_unit_share_the_largest_guess(
    nlp: rt.transcription.Nlp, name: str, unit: str
) -> None:
    own = columns(nlp, name, unit)
    assert len(set(nlp.variables.meaning[own])) > 1
    np.testing.assert_allclose(nlp.scale[own], np.max(np.abs(nlp.guess[own])))


def test_bounds_come_before_the_guess(nlp: rt.transcription.Nlp) -> None:
    effort = columns(nlp, "effort", "N m")
    np.testing.assert_allclose(nlp.scale[effort], nlp.variables.upper[effort])


def test_states_of_a_system_keep_their_own() -> None:
    system = rt.System(
        ["near", "far"], ["u"], lambda point: [point.u["u"], point.x["near"]], units={"near": "m", "far": "m"}
    )
    phase = rt.Phase(system, 1.0, rt.State([0.0, 0.0]), rt.State([0.01, 50.0]), rt.Lagrange(lambda p: p.u["u"] ** 2))
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4))
    assert set(nlp.scale[columns(nlp, "state", "m")].tolist()) == {0.01, 50.0}


def test_defects_are_scaled_alike_in_every_unit_of_the_states() -> None:
    """A launch to an orbit has positions of 6e6 m; its defects had gradients of 6e4 and took 1,367 iterations."""

    def gradients(unit: float) -> np.ndarray:
        system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"] * unit - 1e3 * p.x["v"]])
        ends = rt.State([0.0, 0.0]), rt.State([unit, 2.0 * unit])
        phase = rt.Phase(system, 1.0, *ends, rt.Lagrange(lambda p: p.u["u"] ** 2))
        nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4))
        defects = [i for i, entry in enumerate(nlp.rows.entries) if entry.name == "defect"]
        scaled = nlp.row_scale[:, None] * nlp.jacobian(nlp.guess).toarray() * nlp.scale
        return scaled[np.isin(nlp.rows.meaning, defects)]

    plain = gradients(1.0)
    assert 0.5 < np.max(np.abs(plain)) < 10.0
    for unit in (1e-2, 1e7):
        np.testing.assert_allclose(gradients(unit), plain, rtol=1e-9, atol=1e-12)
