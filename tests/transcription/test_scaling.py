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


def row_sizes(kilogram: float) -> np.ndarray:
    """Return the largest scaled gradient of every row of an arm in least time, in other units of mass."""
    model = rt.load("two_link_arm").model.copy()
    for body in model.inertias:
        body.mass, body.inertia = kilogram * body.mass, kilogram * body.inertia
    model.upperEffortLimit, model.damping = kilogram * np.array([40.0, 20.0]), kilogram * model.damping
    model.lowerEffortLimit, model.friction = -model.upperEffortLimit, kilogram * model.friction
    ends = rt.State(q=[-0.5, 0.3], v=0), rt.State(q=[0.8, 1.1], v=0)
    nlp = nlp_of(rt.Problem([rt.Phase(rt.load(model), (0.1, 10.0), *ends, rt.Duration())]), rt.Mesh(6))
    scaled = nlp.row_scale[:, None] * nlp.jacobian(nlp.guess).toarray() * nlp.scale
    return np.asarray(np.abs(scaled).max(axis=1))


@pytest.mark.filterwarnings("ignore:.*weighs")
@pytest.mark.parametrize("kilogram", [1e-3, 1e-6, 1e-12])
def test_rows_are_scaled_alike_in_every_unit_of_mass(kilogram: float) -> None:
    """With a least size of gradients, relative to 1, equations of motion of 1e-9 N m were solved to 1e-3 of that."""
    np.testing.assert_allclose(row_sizes(kilogram), row_sizes(1.0), rtol=1e-9)


@pytest.mark.parametrize(("lower", "upper"), [(0.0, 0.0), (-1.0, np.inf)])
def test_a_gradient_that_vanishes_at_the_guess_is_no_size(lower: float, upper: float) -> None:
    """The row of x^3 has nearly the gradient 0 at the guess x = 0, where a scale by that would be without bound."""
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    row = rt.PathConstraint(
        lambda point: point.x["x"] ** 3 + 1e-9 * point.x["x"], lower=lower, upper=upper, name="cubic"
    )
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
    nlp = nlp_of(
        rt.Problem([rt.Phase(system, 1.0, rt.State([0.0]), rt.State([0.0]), cost, constraints=[row])]), rt.Mesh(4)
    )
    cubic = [i for i, entry in enumerate(nlp.rows.entries) if "cubic" in (entry.name, entry.label)]
    assert cubic
    assert nlp.row_scale[np.isin(nlp.rows.meaning, cubic)].max() < 1.01e3


def test_an_inequality_in_small_units_is_scaled_by_its_bounds() -> None:
    """A limit of 1e-12 whose row has a size of 1e-3 is held to 1e-11."""
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    row = rt.PathConstraint(lambda point: 1e-12 * point.x["x"], lower=-1e-12, upper=1e-12, name="small")
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
    nlp = nlp_of(
        rt.Problem([rt.Phase(system, 1.0, rt.State([0.0]), rt.State([0.5]), cost, constraints=[row])]), rt.Mesh(4)
    )
    small = np.isin(nlp.rows.meaning, [i for i, e in enumerate(nlp.rows.entries) if "small" in (e.name, e.label)])
    assert small.any()
    assert 0.1 < nlp.rows.upper[small].max() * nlp.row_scale[small].max() < 10.0
