"""rt.engines.Native(): the numbers of CasADi's graphs, by tapes of eight points and by analytical inverse dynamics."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.native.engines.base import Engine, StageMapped
from robotraj.transcription.assembly.function_parts import solved_for
from robotraj.transcription.assembly.point_functions import PointFunctions

COUNT = 11
"""Points: more than a pack of eight, and no multiple of it."""


def arm(name: str, locked: dict[str, float] | None = None, root: str = "fixed") -> rt.Phase:
    """A robot with damping and friction, free time, a parameter, and cost in accelerations and torques."""
    robot = rt.load(name, locked=locked or {}, root=root)
    robot = replace(robot, damping=np.full(robot.nv, 0.2), friction=np.full(robot.nv, 0.3))
    last = robot.frame_names[-1]
    rows = rt.PathConstraint(lambda point: point.frame(last).position[2] * point.tau[0] + point.p["lift"], lower=-5)
    return rt.Phase(
        robot,
        (0.5, 2.0),
        objective=rt.Effort() + rt.Lagrange(lambda point: point.a[0] ** 2 * point.q[-1]),
        constraints=[rows],
        parameters={"lift": rt.between(0.0, 1.0)},
        limits=None,
    )


def standing(name: str, root: str, feet: list[str], known: dict[str, float] | None = None) -> rt.Phase:
    robot, contacts = rt.load(name, root=root), [rt.PointContact(foot) for foot in feet]
    return rt.Phase(robot, 0.3, objective=rt.Effort(), contacts=contacts, parameters=known or {})


def on_soles(feet: list[str]) -> rt.Phase:
    robot = rt.load("talos_legs", root="floating")
    # With force rates the forces are states, from which the terms of a foot read them.
    contacts = [rt.FlatFoot(foot, 0.2, 0.1, ground=rt.terrain.Slope(0.1)) for foot in feet]
    return rt.Phase(robot, 0.3, objective=rt.Effort() + rt.objectives.ForceRate(), contacts=contacts)


FINGERS = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}

PHASES: dict[str, Callable[[], rt.Phase]] = {
    "two joints": lambda: arm("double_pendulum"),
    "a cart that slides": lambda: arm("cartpole"),
    "ur5": lambda: arm("ur5"),
    "panda": lambda: arm("panda", FINGERS),
    "kinova": lambda: arm("kinova"),
    "four legs on one fixed body": lambda: arm("solo12"),
    "legs in the plane": lambda: standing("five_link", "planar", ["left_foot"]),
    "free-flyer": lambda: arm("solo12", root="floating"),
    "free-flyer on two feet": lambda: standing("solo12", "floating", ["FL_FOOT", "HR_FOOT"]),
    "a foothold that is known": lambda: standing("solo12", "floating", ["FL_FOOT", "HR_FOOT"], {"HR_FOOT.x": 0.1}),
    "a sole on a slope": lambda: on_soles(["left_sole_link"]),
    "two soles on a slope": lambda: on_soles(["left_sole_link", "right_sole_link"]),
}


def stage_of(phase: rt.Phase, engine: Engine | None) -> PointFunctions:
    """Stage of the points between the ends."""
    nlp = rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(2), rt.guess.StraightLine(), engine=engine)
    return nlp.blocks[0].stage


def solved(stage: PointFunctions, joints: int) -> PointFunctions:
    """Make the torques expressions, as stages have them, so that the cost is curved in the dynamics."""
    return solved_for(stage, range(2 * joints, 3 * joints), range(3 * joints, 4 * joints))


def points_of(stage: PointFunctions, count: int = COUNT) -> tuple[Array, Array, Array]:
    """Unknowns, constants and multipliers at random points, (n, count)."""
    rng = np.random.default_rng(5)
    sizes = stage.inputs, stage.function.numel_in(1), stage.outputs
    return tuple(rng.uniform(0.2, 1.2, (n, count)) * rng.choice([-1, 1], (n, count)) for n in sizes)


def evaluated(stage: PointFunctions, points: tuple[Array, ...], threads: int = 1) -> dict[str, Array]:
    """Every result of the compiled block, derivatives as dense matrices, (count, ...)."""
    count = points[0].shape[1]
    block = rt.engines.Native().block(stage, count, stage.costed is not None)
    v, c, m = (np.ascontiguousarray(each.T).ravel() for each in points)
    found = {"function": block.values(v, c, threads)}
    if stage.costed is not None:
        found |= {"cost": block.cost(v, c, threads), "gradient": block.gradient(v, c, threads)}
    found = {name: values.reshape(count, -1) for name, values in found.items()}
    numbers = {"jacobian": block.jacobian(v, c, threads), "hessian": block.hessian(v, c, m, threads)}
    return found | {name: dense(stage, name, values.reshape(count, -1)) for name, values in numbers.items()}


def dense(stage: PointFunctions, name: str, values: Array) -> Array:
    rows, columns = getattr(stage, f"{name}_pattern")
    full = np.zeros((len(values), stage.inputs if name == "hessian" else stage.outputs, stage.inputs))
    full[:, rows, columns] = values
    return full


def expected(stage: PointFunctions, points: tuple[Array, ...]) -> dict[str, Array]:
    """The same by CasADi's virtual machine, from the graph of everything."""
    count = points[0].shape[1]
    found = {}
    for name in ("function", "cost", "gradient", "jacobian", "hessian"):
        if name in ("cost", "gradient") and stage.costed is None:
            continue
        function = getattr(stage, name)
        values = np.array(function.map(count)(*points[: function.n_in()])).T
        found[name] = dense(stage, name, values) if name in ("jacobian", "hessian") else values
    return found


def assert_same(found: dict[str, Array], wanted: dict[str, Array], tolerance: float = 1e-9) -> None:
    assert found.keys() == wanted.keys()
    for name, values in wanted.items():
        assert found[name].shape == values.shape
        np.testing.assert_allclose(
            found[name], values, rtol=0, atol=tolerance * max(1.0, np.abs(values).max()), err_msg=name
        )


@pytest.mark.parametrize("name", PHASES)
def test_values_and_derivatives_are_those_of_the_graph(name: str) -> None:
    phase = PHASES[name]()
    plain, native = stage_of(phase, None), stage_of(phase, rt.engines.Native())
    assert plain.torques is None
    assert native.torques is not None
    points = points_of(plain)
    assert_same(evaluated(native, points), expected(plain, points))
    # Without separate torques, a stage is evaluated as one tape.
    whole = copy(plain)
    whole.as_tapes = True
    assert_same(evaluated(whole, points), expected(plain, points))


@pytest.mark.parametrize("name", ["two joints", "ur5", "four legs on one fixed body"])
def test_torques_that_are_expressions_bend_the_cost(name: str) -> None:
    phase = PHASES[name]()
    plain, native = (solved(stage_of(phase, engine), len(phase.dae.controls)) for engine in (None, rt.engines.Native()))
    assert native.torques is not None
    assert native.inputs < stage_of(phase, None).inputs
    points = points_of(plain)
    assert_same(evaluated(native, points), expected(plain, points))


def stretched(stage: PointFunctions, joints: int, first: int) -> PointFunctions:
    """Write velocities as v' / s, accelerations as a' / s^2 and one position as a sum, with s a further unknown."""
    s = ca.SX.sym("s")
    where = [0, *range(first, first + 2 * joints)]
    v = stage.v[where]
    moved = ca.vertcat(v[0] + v[1] * stage.c[0], v[1 : 1 + joints] / s, v[1 + joints :] / s**2)
    torques = stage.torques and stage.torques.substituted(v, moved)
    return PointFunctions(ca.vertcat(stage.v, s), stage.c, ca.substitute(stage.y, v, moved), stage.costed, torques)


@pytest.mark.parametrize("name", ["two joints", "panda", "four legs on one fixed body", "free-flyer"])
@pytest.mark.parametrize("expressions", [False, True])
def test_arguments_of_the_dynamics_may_be_expressions(name: str, expressions: bool) -> None:
    phase = PHASES[name]()
    joints, first = len(phase.dae.algebraic), len(phase.dae.states) - len(phase.dae.algebraic)
    made = [stage_of(phase, engine) for engine in (None, rt.engines.Native())]
    if expressions and joints == len(phase.dae.controls):
        made = [solved(stage, joints) for stage in made]
    plain, native = (stretched(stage, joints, first) for stage in made)
    assert native.torques is not None
    points = points_of(plain)
    assert_same(evaluated(native, points), expected(plain, points))


@pytest.mark.parametrize("name", ["ur5", "free-flyer on two feet"])
def test_a_stage_with_torques_apart_has_the_functions_of_one_without(name: str) -> None:
    phase = PHASES[name]()
    plain, native = stage_of(phase, None), stage_of(phase, rt.engines.Native())
    points = points_of(plain)
    assert_same(expected(native, points), expected(plain, points), 1e-13)


def test_where_nothing_turns_the_dynamics_are_linear_numbers() -> None:
    """Two slides at a slant to each other, with rotors: M is no diagonal, and gravity acts along one of them."""
    model = pin.Model()
    place = pin.SE3(pin.AngleAxis(0.7, np.array([0.0, 1.0, 0.0])).matrix(), np.array([0.1, -0.2, 0.3]))
    first = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "rail")
    second = model.addJoint(first, pin.JointModelPrismaticUnaligned(np.array([0.6, 0.0, 0.8])), place, "lift")
    for joint in (first, second):
        model.appendBodyToJoint(joint, pin.Inertia(2.0, np.array([0.1, 0.2, -0.3]), np.eye(3)), place)
    model.armature = np.array([0.3, 0.05])
    phase = rt.Phase(rt.load(model), (0.5, 2.0), objective=rt.Effort(), limits=None)
    plain, native = stage_of(phase, None), stage_of(phase, rt.engines.Native())
    assert plain.torques is None
    assert native.torques is None
    points = points_of(plain)
    wanted = expected(plain, points)
    assert np.abs(wanted["function"]).max() > 0.1
    assert_same(evaluated(native, points), wanted, 1e-13)


@pytest.mark.parametrize("name", ["panda", "free-flyer"])
def test_derivatives_are_finite_differences_of_values(name: str) -> None:
    stage = stage_of(PHASES[name](), rt.engines.Native())
    v, c, m = points_of(stage, 1)
    here = evaluated(stage, (v, c, m))
    h = 1e-6
    for i in range(stage.inputs):
        step = np.zeros_like(v)
        step[i] = h
        above, below = (evaluated(stage, (v + s * step, c, m)) for s in (1.0, -1.0))
        slope = {key: (above[key] - below[key])[0] / (2 * h) for key in above}
        scale = np.abs(here["jacobian"]).max()
        np.testing.assert_allclose(here["jacobian"][0, :, i], slope["function"], rtol=0, atol=1e-7 * scale)
        np.testing.assert_allclose(here["gradient"][0, i], slope["cost"], rtol=1e-6, atol=1e-7 * scale)
        symmetric = here["hessian"][0] + np.tril(here["hessian"][0], -1).T
        bent = m[:, 0] @ slope["jacobian"]
        np.testing.assert_allclose(symmetric[i], bent, rtol=0, atol=1e-7 * np.abs(symmetric).max())


@pytest.mark.parametrize("name", ["ur5", "free-flyer on two feet"])
def test_any_number_of_threads_gives_the_same_bits(name: str) -> None:
    stage = stage_of(PHASES[name](), rt.engines.Native())
    # Enough points for more than one thread.
    points = points_of(stage, 601)
    one, two = (evaluated(stage, points, threads) for threads in (1, 2))
    assert all(np.array_equal(one[key], two[key]) for key in one)


def test_a_point_has_the_same_bits_in_any_company() -> None:
    stage = stage_of(PHASES["ur5"](), rt.engines.Native())
    points = points_of(stage, 9)
    together = evaluated(stage, points)
    alone = [evaluated(stage, tuple(each[:, i : i + 1] for each in points)) for i in range(9)]
    assert all(np.array_equal(together[key], np.concatenate([a[key] for a in alone])) for key in together)


def test_patterns_follow_the_branches_of_the_tree() -> None:
    stage = stage_of(PHASES["four legs on one fixed body"](), rt.engines.Native())
    plain = stage_of(PHASES["four legs on one fixed body"](), None)
    for name in ("jacobian_pattern", "hessian_pattern"):
        chained, own = (set(zip(*getattr(s, name), strict=True)) for s in (stage, plain))
        assert own <= chained
        assert len(chained) < 1.5 * len(own)


def test_the_graph_of_the_dynamics_is_not_built(monkeypatch: pytest.MonkeyPatch) -> None:
    phase = PHASES["ur5"]()
    problem = rt.Problem([phase])

    def refuse(*_: Any) -> None:
        raise AssertionError("the graph of the inverse dynamics was asked for")

    monkeypatch.setattr("robotraj.symbolic.SymbolicModel.inverse_dynamics", property(refuse))
    nlp = rt.transcription.transcribe(problem, rt.Mesh(3), rt.guess.StraightLine(), engine=rt.engines.Native())
    assert nlp.functions.rows(nlp.guess / nlp.scale, []).shape[0] == len(nlp.rows)
    with pytest.raises(AssertionError, match="was asked for"):
        rt.transcription.transcribe(problem, rt.Mesh(3), rt.guess.StraightLine())


def test_a_plan_takes_the_same_steps_to_the_same_answer() -> None:
    start, end = (-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort())
    plain, native = (
        rt.plan(phase, rt.Mesh(10), rt.guess.StraightLine(), engine=engine)
        for engine in (rt.engines.VirtualMachine(), rt.engines.Native())
    )
    assert native.iterations == plain.iterations
    assert native.objective == pytest.approx(plain.objective, rel=1e-9)


def test_shooting_stays_with_the_virtual_machine() -> None:
    phase = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=0.3, v=0), rt.Effort())
    mesh = rt.Mesh(8, rt.schemes.MultipleShooting())
    plain, native = (
        rt.plan(phase, mesh, engine=engine) for engine in (rt.engines.VirtualMachine(), rt.engines.Native())
    )
    assert native.objective == pytest.approx(plain.objective, rel=1e-9)


def test_expressions_that_call_functions_stay_with_the_virtual_machine() -> None:
    table = ca.interpolant("table", "bspline", [np.linspace(-4, 4, 12)], np.linspace(-1, 1, 12) ** 2)
    phase = replace(PHASES["ur5"](), objective=rt.Lagrange(lambda point: table(point.q[0]) + point.tau[1] ** 2))
    plain, native = stage_of(phase, None), stage_of(phase, rt.engines.Native())
    assert native.tapes is None
    points = points_of(plain)
    assert_same(evaluated(native, points), expected(plain, points))


def test_unknown_masses_keep_the_graph() -> None:
    robot = rt.load("two_link_arm")
    design, parameters = {"load": rt.design.Payload(robot.frame_names[-1])}, {"load": rt.between(0.5, 1.5)}
    phase = rt.Phase(robot, 1.0, objective=rt.Effort(), design=design, parameters=parameters)
    assert stage_of(phase, rt.engines.Native()).torques is None


def test_every_operation_of_a_graph() -> None:
    x, y = ca.SX.sym("x", 2), ca.SX.sym("y", 1)
    a, b = x[0], x[1]
    outputs = [
        a + b, a - b, a * b, a / b, -a, a**2, 2 * a, 1 / a, ca.sin(a), ca.cos(a), ca.tan(a), ca.asin(a / 9),
        ca.acos(a / 9), ca.atan(a), ca.atan2(a, b), ca.sinh(a), ca.cosh(a), ca.tanh(a), ca.exp(a), ca.log(a * a),
        ca.sqrt(b * b), ca.fabs(a), ca.sign(a), ca.floor(a), ca.ceil(a), ca.fmin(a, b), ca.fmax(a, b), ca.fmod(a, b),
        ca.if_else(a > b, a, b), ca.logic_and(a > 0, b > 0), ca.logic_not(a > 0), a == b, a != b, a <= b, ca.erf(a),
        ca.power(b * b, a), b**3, ca.copysign(a, b), ca.hypot(a, b), ca.log1p(b * b), ca.expm1(a), y[0] * 0.1, 3.5,
    ]  # fmt: skip
    stage = PointFunctions(x, y, ca.vertcat(*outputs))
    points = points_of(stage, 20)
    v, c, _ = (np.ascontiguousarray(each.T).ravel() for each in points)
    found = rt.engines.Native().block(stage, 20, False).values(v, c).reshape(20, -1)
    wanted = np.array(stage.function.map(20)(*points[:2])).T
    waves = slice(8, 10)  # sines and cosines, which whole packs take together
    np.testing.assert_allclose(found[:, waves], wanted[:, waves], rtol=0, atol=4e-16)
    found[:, waves] = wanted[:, waves]
    assert np.array_equal(found, wanted)


def test_sines_of_any_angle() -> None:
    x = ca.SX.sym("x")
    stage = PointFunctions(x, ca.SX.sym("c", 0), ca.vertcat(ca.sin(x), ca.cos(x)))
    angles = np.concatenate([np.linspace(-10, 10, 41), [1e5, -1e6, 3e6, 1e22]])
    found = rt.engines.Native().block(stage, len(angles), False).values(angles, np.zeros(0)).reshape(-1, 2)
    np.testing.assert_allclose(found, np.column_stack([np.sin(angles), np.cos(angles)]), rtol=0, atol=4e-16)


def test_prepared_functions_stay_alive_with_those_that_call_them() -> None:
    stage = stage_of(PHASES["two joints"](), rt.engines.Native())
    [function] = rt.engines.Native().prepare([StageMapped(stage, "jacobian", COUNT)])
    points = points_of(stage)
    wanted = np.array(stage.jacobian.map(COUNT)(*points[:2]))
    np.testing.assert_allclose(np.array(function(*points[:2])), wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


def test_fewer_threads_than_one_are_refused() -> None:
    with pytest.raises(rt.InputError, match="threads"):
        rt.engines.Native(threads=0)
