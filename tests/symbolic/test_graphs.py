"""The functions as objects: their names, shapes and sizes, and what is cached or copied."""

from __future__ import annotations

import doctest
import importlib
import pickle

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj.symbolic import SymbolicModel

SIGNATURES = {
    "forward_dynamics": (["q", "v", "tau", "fext"], ["a"]),
    "inverse_dynamics": (["q", "v", "a", "fext"], ["tau"]),
    "mass_matrix": (["q"], ["M"]),
    "nonlinear_effects": (["q", "v"], ["nle"]),
    "gravity": (["q"], ["g"]),
    "kinetic_energy": (["q", "v"], ["energy"]),
    "potential_energy": (["q"], ["energy"]),
    "center_of_mass": (["q", "v", "a"], ["position", "velocity", "acceleration"]),
    "centroidal_momentum": (["q", "v"], ["h"]),
    "integrate": (["q", "dv"], ["q1"]),
    "difference": (["q0", "q1"], ["dv"]),
    "configuration_rate": (["q", "v"], ["qdot"]),
}
FRAME_SIGNATURES = {
    "frame_placement": (["q"], ["position", "rotation"]),
    "frame_velocity": (["q", "v"], ["velocity"]),
    "frame_acceleration": (["q", "v", "a"], ["acceleration"]),
    "frame_jacobian": (["q"], ["J"]),
}


@pytest.mark.parametrize("name", [*SIGNATURES, *FRAME_SIGNATURES])
def test_names_and_dense_shapes(case, name: str) -> None:
    if name in SIGNATURES:
        function, (inputs, outputs) = getattr(case.symbolic, name), SIGNATURES[name]
    else:
        function, (inputs, outputs) = getattr(case.symbolic, name)(case.frames[0]), FRAME_SIGNATURES[name]
    assert function.name_in() == inputs
    assert function.name_out() == outputs
    assert all(function.sparsity_in(i).is_dense() for i in range(function.n_in()))
    assert all(function.sparsity_out(i).is_dense() for i in range(function.n_out()))
    assert function.is_a("SXFunction")
    sizes = {"q": case.model.nq, "q0": case.model.nq, "q1": case.model.nq, "qdot": case.model.nq}
    for index, key in enumerate(inputs):
        expected = (6, case.model.njoints) if key == "fext" else (sizes.get(key, case.model.nv), 1)
        assert function.size_in(index) == expected


def without_forces(function: ca.Function) -> ca.Function:
    symbols = [ca.SX.sym(name, function.sparsity_in(i)) for i, name in enumerate(function.name_in()[:3])]
    return ca.Function("without_forces", symbols, [function(*symbols, 0)])


def test_zero_external_forces_vanish(arm) -> None:
    """A call with zeros of any shape removes both their inputs and their additions from the graph."""
    full = arm.symbolic.inverse_dynamics
    q, v, a = (ca.SX.sym(name, arm.model.nv) for name in "qva")
    dense = ca.Function("dense", [q, v, a], [full(q, v, a, np.zeros((6, arm.model.njoints)))])
    bare = without_forces(full)
    assert bare.n_instructions() == dense.n_instructions()
    # Six loads and at least one addition for each wrench but the universe's are gone.
    assert bare.n_instructions() <= full.n_instructions() - 7 * (arm.model.njoints - 1)


def test_inverse_dynamics_is_the_smaller_graph(arm) -> None:
    inverse = without_forces(arm.symbolic.inverse_dynamics).n_instructions()
    forward = without_forces(arm.symbolic.forward_dynamics).n_instructions()
    assert 2 * inverse < forward


def test_forward_and_inverse_dynamics_undo_each_other(case) -> None:
    (a,) = case.evaluate(case.symbolic.forward_dynamics)
    (tau,) = case.evaluate(case.symbolic.inverse_dynamics, a=a[:, :, 0].T)
    np.testing.assert_allclose(tau[:, :, 0].T, case.points["tau"], rtol=0, atol=1e-8)


def test_functions_are_kept_and_shared_by_equal_models(arm) -> None:
    again = SymbolicModel(arm.model.copy())
    assert again.gravity is arm.symbolic.gravity
    heavier = arm.model.copy()
    heavier.inertias[1].mass += 1.0
    assert SymbolicModel(heavier).mass_matrix is not arm.symbolic.mass_matrix


def test_model_is_copied(arm) -> None:
    model = arm.model.copy()
    symbolic = SymbolicModel(model)
    model.gravity.linear = np.zeros(3)
    symbolic.model.gravity.linear = np.zeros(3)
    q = arm.points["q"][:, 0]
    expected = pin.computeGeneralizedGravity(arm.model, arm.data, q)
    np.testing.assert_allclose(np.array(symbolic.gravity(q)).ravel(), expected, rtol=1e-12)


@pytest.mark.parametrize("parametric", [False, True])
def test_pickles_small_and_comes_back(arm, parametric: bool) -> None:
    symbolic = SymbolicModel(arm.model, parametric=parametric)
    text = pickle.dumps(symbolic)
    assert len(text) < 100_000
    back = pickle.loads(text)
    assert back.parametric is parametric
    assert repr(back) == repr(symbolic)
    assert str(back.gravity) == str(symbolic.gravity)


@pytest.mark.parametrize("module", ["robotraj.symbolic", "robotraj.symbolic.model"])
def test_examples_in_the_docstrings(module: str) -> None:
    result = doctest.testmod(importlib.import_module(module))
    assert result.attempted > 0
    assert result.failed == 0
