"""Functions of models with mimic joints are Pinocchio's own, which this room does not use for them."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj.robot.coupling.coupled_model import coupled
from robotraj.symbolic import SymbolicModel
from tests.robot.coupling.random_trees import random_tree


@pytest.mark.parametrize("seed", range(6))
def test_values_are_pinocchios(seed: int) -> None:
    model = coupled(*random_tree(seed, floating=seed % 2 == 1))
    symbolic, data = SymbolicModel(model), model.createData()
    rng = np.random.default_rng(seed)
    q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    v, a = rng.normal(size=(2, model.nv))
    none = np.zeros((6, model.njoints))
    name, frame = "tip3", model.getFrameId("tip3")
    pin.centerOfMass(model, data, q, v, a)
    pairs = [
        (symbolic.inverse_dynamics(q, v, a, none), pin.rnea(model, model.createData(), q, v, a)),
        (symbolic.nonlinear_effects(q, v), pin.nonLinearEffects(model, model.createData(), q, v)),
        (symbolic.gravity(q), pin.computeGeneralizedGravity(model, model.createData(), q)),
        (symbolic.center_of_mass(q, v, a)[2], data.acom[0]),
        (symbolic.centroidal_momentum(q, v), pin.computeCentroidalMomentum(model, model.createData(), q, v).vector),
        (symbolic.integrate(q, v), pin.integrate(model, q, v)),
        (symbolic.difference(q, pin.integrate(model, q, 0.1 * v)), 0.1 * v),
        (
            symbolic.frame_jacobian(name)(q),
            pin.computeFrameJacobian(model, model.createData(), q, frame, pin.LOCAL_WORLD_ALIGNED),
        ),
    ]
    for mine, expected in pairs:
        np.testing.assert_allclose(np.array(mine).reshape(np.shape(expected)), expected, atol=1e-10)


def test_inertias_and_lengths_may_be_symbols() -> None:
    model = coupled(*random_tree(1))
    symbolic = SymbolicModel(model, parametric=True)
    rng, none = np.random.default_rng(0), np.zeros((6, model.njoints))
    q, v, tau = rng.normal(size=(3, model.nv))
    given = (symbolic.model_inertias, symbolic.model_translations)
    a = symbolic.forward_dynamics(q, v, tau, none, *given)
    np.testing.assert_allclose(np.array(a), np.array(SymbolicModel(model).forward_dynamics(q, v, tau, none)), rtol=1e-9)
    heavier = given[0] * 2.0
    assert np.abs(np.array(symbolic.forward_dynamics(q, v, tau, none, heavier, given[1]) - a)).max() > 1e-3


def test_an_input_of_symbols_is_accepted() -> None:
    model = coupled(*random_tree(2))
    q = ca.SX.sym("q", model.nq)
    placed = SymbolicModel(model).frame_placement("tip1")(q)[0]
    assert placed.shape == (3, 1) and ca.depends_on(placed, q)
