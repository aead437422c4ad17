"""Inverse dynamics and its derivatives: Pinocchio's numbers, on every kind of processor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.native._native import NotATape, Recipe, StageGraph, Tape, TapeBlock, Torques, processors
from robotraj.native.rigid_tree import rigid_tree

NONE: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
COUNT = 10

ROBOTS: dict[str, dict[str, Any]] = {
    "double_pendulum": {},
    "cartpole": {},
    "ur5": {},
    "panda": {},
    "talos": {},
    "five_link": {"root": "planar"},
    "solo12": {"root": "floating"},
    "bolt": {"root": "floating"},
}


def graph(inputs: list[ca.SX], result: ca.SX) -> StageGraph:
    """A stage function of (v, c, r)."""
    return StageGraph(ca.Function("stage", inputs, [result, ca.SX(0, 1)]).serialize())


def recipe(tape: Tape, at: int, count: int, **parts: bool) -> Recipe:
    given = {"jacobian": False, "hessian": False} | parts
    return Recipe(tape, **given, made=0, result=at, results=count, out=NONE, left=NONE, right=NONE)


@dataclass
class Dynamics:
    """The bare block tau = RNEA(x), its numbers in the order of the tree's patterns."""

    model: pin.Model
    processor: str = ""

    def __post_init__(self) -> None:
        self.tree = rigid_tree(self.model)
        nq, nv = self.model.nq, self.model.nv
        assert (self.tree.positions, self.tree.rates) == (nq, nv)
        n = nq + 2 * nv
        x, c, r = (ca.SX.sym(name, size) for name, size in (("x", n), ("c", 0), ("r", nv)))
        numbers = [len(pattern[0]) for pattern in (self.tree.jacobian_pattern(), self.tree.hessian_pattern())]
        self.block = TapeBlock(
            COUNT,
            n,
            0,
            recipe(graph([x, c, r], r).values(), 1, nv),
            recipe(graph([x, c, r], ca.SX(0, 1)).values(), 1, numbers[0], jacobian=True),
            # The multipliers of r, of which nothing is curved.
            recipe(graph([x, c, r], r).curvature()[0], 1 + nv, numbers[1], hessian=True),
            torques=Torques(self.tree, np.arange(n)),
            processor=self.processor,
        )

    def torques(self, x: Array) -> Array:
        return self.block.values(x.ravel(), np.zeros(0)).reshape(COUNT, -1)

    def jacobian(self, x: Array) -> Array:
        rows, columns = self.tree.jacobian_pattern()
        full = np.zeros((COUNT, self.model.nv, x.shape[1]))
        full[:, rows, columns] = self.block.jacobian(x.ravel(), np.zeros(0)).reshape(COUNT, -1)
        return full

    def hessian(self, x: Array, test: Array) -> Array:
        rows, columns = self.tree.hessian_pattern()
        full = np.zeros((COUNT, x.shape[1], x.shape[1]))
        numbers = self.block.hessian(x.ravel(), np.zeros(0), test.ravel()).reshape(COUNT, -1)
        full[:, rows, columns] = numbers
        full[:, columns, rows] = numbers
        return full


def load(name: str) -> pin.Model:
    model = rt.load(name, **ROBOTS[name]).model
    model.armature[model.nv - model.njoints + 2 :] = np.linspace(0.1, 0.4, model.njoints - 2)
    return model


def states(model: pin.Model) -> Array:
    """Random x = (q, w, a), (COUNT, nq + 2 nv); a free-flyer's quaternion is one."""
    rng = np.random.default_rng(3)
    x = rng.standard_normal((COUNT, model.nq + 2 * model.nv))
    if model.nq > model.nv:
        x[:, 3:7] /= np.linalg.norm(x[:, 3:7], axis=1)[:, None]
    return x


@pytest.mark.parametrize("processor", processors())
@pytest.mark.parametrize("name", ROBOTS)
def test_torques_and_first_derivatives_are_pinocchios(name: str, processor: str) -> None:
    model = load(name)
    data, dynamics, x = model.createData(), Dynamics(model, processor), states(model)
    found, slopes = dynamics.torques(x), dynamics.jacobian(x)
    for e in range(COUNT):
        q, w, a = np.split(x[e], [model.nq, model.nq + model.nv])
        torques = pin.rnea(model, data, q, w, a)
        np.testing.assert_allclose(found[e], torques, rtol=0, atol=1e-12 * np.abs(torques).max())
        by_q, by_w, by_a = pin.computeRNEADerivatives(model, data, q, w, a)
        mine = slopes[e]
        scale = 1e-12 * max(np.abs(part).max() for part in (by_q, by_w, by_a))
        np.testing.assert_allclose(mine[:, model.nq : model.nq + model.nv], by_w, rtol=0, atol=scale)
        np.testing.assert_allclose(mine[:, model.nq + model.nv :], by_a, rtol=0, atol=scale)
        # Pinocchio's is by the tangent: a free-flyer's coordinates move with E(q).
        moved = mine[:, : model.nq] @ tangent(model, q)
        np.testing.assert_allclose(moved, by_q, rtol=0, atol=100 * scale)


def bar(lever: Array) -> pin.Model:
    """A mass of 1 kg on a bar that turns about x, under 1 m/s^2: its torque is a sine or a cosine."""
    model = pin.Model()
    model.gravity.linear = np.array([0.0, 0.0, -1.0])
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "joint")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, lever, np.zeros((3, 3))), pin.SE3.Identity())
    return model


@pytest.mark.parametrize("processor", processors())
def test_sines_are_those_of_the_c_library(processor: str) -> None:
    rng = np.random.default_rng(0)
    quarters = np.pi / 2 * rng.integers(-600_000, 600_000, 500)
    angles = np.concatenate(
        [
            rng.uniform(-4, 4, 1000),
            rng.uniform(-1e6, 1e6, 500),
            quarters,
            quarters + rng.uniform(-1e-8, 1e-8, 500),
            np.pi / 2 * rng.integers(-8, 9, 200) + 10.0 ** rng.uniform(-300, -9, 200),
            rng.uniform(1e6, 1e15, 296),
            [0.0, -0.0, 1e6, -1e6],
        ]
    ).reshape(-1, COUNT)
    sine, cosine = (
        Dynamics(bar(np.array([0.0, 0.0, -1.0])), processor),
        Dynamics(bar(np.array([0.0, 1.0, 0.0])), processor),
    )
    for q in angles:
        x = np.column_stack([q, np.zeros((COUNT, 2))])
        np.testing.assert_allclose(sine.torques(x)[:, 0], np.sin(q), rtol=0, atol=4e-16)
        np.testing.assert_allclose(cosine.torques(x)[:, 0], np.cos(q), rtol=0, atol=4e-16)


@pytest.mark.parametrize("processor", processors())
def test_what_is_no_angle_gives_no_torque(processor: str) -> None:
    x = np.zeros((COUNT, 3))
    x[:3, 0] = np.nan, np.inf, -np.inf
    torques = Dynamics(bar(np.array([0.0, 0.0, -1.0])), processor).torques(x)[:, 0]
    assert np.isnan(torques[:3]).all()
    np.testing.assert_array_equal(torques[3:], 0.0)


def tangent(model: pin.Model, q: Array) -> Array:
    """Derivative of q (+) dv at dv = 0, (nq, nv)."""
    moved = np.zeros((model.nq, model.nv))
    function = rt.symbolic.SymbolicModel(model).configuration_rate
    for i in range(model.nv):
        moved[:, i] = np.array(function(q, np.eye(model.nv)[i])).ravel()
    return moved


@pytest.mark.parametrize("processor", processors())
@pytest.mark.parametrize("name", ROBOTS)
def test_second_derivatives_are_differences_of_pinocchios_first(name: str, processor: str) -> None:
    model = load(name)
    data, dynamics, x = model.createData(), Dynamics(model, processor), states(model)
    test = np.random.default_rng(4).standard_normal((COUNT, model.nv))
    found = dynamics.hessian(x, test)
    h = 1e-6

    def slopes(q: Array, w: Array, a: Array) -> Array:
        return np.concatenate([part.T @ test[0] for part in pin.computeRNEADerivatives(model, data, q, w, a)])

    q, w, a = np.split(x[0], [model.nq, model.nq + model.nv])
    for i in range(model.nv):
        step = h * np.eye(model.nv)[i]
        by_w = (slopes(q, w + step, a) - slopes(q, w - step, a)) / (2 * h)
        by_a = (slopes(q, w, a + step) - slopes(q, w, a - step)) / (2 * h)
        for mine, theirs in ((found[0, model.nq + i], by_w), (found[0, model.nq + model.nv + i], by_a)):
            moved = np.concatenate([tangent(model, q).T @ mine[: model.nq], mine[model.nq :]])
            np.testing.assert_allclose(moved, theirs, rtol=0, atol=1e-7 * np.abs(found[0]).max())
    # The derivative by q, forward and back: only the dependence on positions is left.
    free = slice(7, model.nq) if model.nq > model.nv else slice(0, model.nq)
    for i in range(model.nv - (free.stop - free.start), model.nv):
        step = h * np.eye(model.nv)[i]
        ahead, back = (pin.integrate(model, q, s * step) for s in (1.0, -1.0))
        bent = (slopes(ahead, w, a) - slopes(back, w, a)) / (2 * h)
        mine = found[0, i + model.nq - model.nv]
        offset = model.nq - model.nv
        np.testing.assert_allclose(
            mine[free], bent[free.start - offset : free.stop - offset], rtol=0, atol=1e-7 * np.abs(found[0]).max()
        )


def test_a_joint_that_neither_turns_nor_slides_is_named() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), "ball")
    with pytest.raises(ValueError, match="'ball'.*neither turns"):
        rigid_tree(model)


def test_a_free_flyer_has_nothing_beside_it() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "beside")
    with pytest.raises(ValueError, match="'beside' is attached to the world"):
        rigid_tree(model)


def test_wrong_sizes_are_refused() -> None:
    model = load("ur5")
    tree = rigid_tree(model)
    v, c, r = ca.SX.sym("v", 3), ca.SX.sym("c", 0), ca.SX.sym("r", 6)
    plain = recipe(graph([v, c, r], v).values(), 1, 3)
    with pytest.raises(ValueError, match="place for every argument"):
        TapeBlock(1, 3, 0, plain, plain, plain, torques=Torques(tree, np.arange(2)))
    with pytest.raises(ValueError, match="lies outside v"):
        TapeBlock(1, 3, 0, plain, plain, plain, torques=Torques(tree, np.full(18, 3)))
    with pytest.raises(ValueError, match="other arguments"):
        TapeBlock(1, 3, 0, plain, plain, plain)
    with pytest.raises(ValueError, match="result lies outside"):
        long = recipe(graph([v, c, ca.SX(0, 1)], v).values(), 1, 4)
        TapeBlock(1, 3, 0, long, long, long)
    with pytest.raises(NotATape, match="scalar graph"):
        x, none = ca.MX.sym("x", 2), ca.MX(0, 1)
        StageGraph(ca.Function("stage", [x, none, none], [2 * x, none]).serialize())
    with pytest.raises(ValueError, match="this processor does not run"):
        TapeBlock(1, 3, 0, plain, plain, plain, processor="abacus")
