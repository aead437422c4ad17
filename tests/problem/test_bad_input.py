"""Bad input of every kind raises one error that names the fault and a remedy."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

NAN = float("nan")


def block(**more: Any) -> rt.Phase:
    """A valid phase of the double integrator, made invalid by ``more``."""
    system = more.pop("system", None) or double_integrator()
    good = {
        "duration": (0.1, 20),
        "start": rt.State([0, 0]),
        "end": rt.State([1, 0]),
        "objective": rt.Duration(),
    }
    good["controls"] = {"u": rt.between(-1, 1)}
    return rt.Phase(system, **(good | more))


TRANSPOSED = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.4, 0.2, 0.3, 1]]


def double_integrator() -> rt.System:
    return rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], name="block")


def cartpole(**more: Any) -> rt.Phase:
    """A valid phase of the cart-pole, made invalid by ``more``."""
    good = {
        "duration": 2.0,
        "start": rt.State(q=[0, 0], v=0),
        "end": rt.State(q=[1, np.pi], v=0),
        "objective": rt.Effort(),
    }
    return rt.Phase(more.pop("robot", None) or rt.load("cartpole"), **(good | more))


def arm(**more: Any) -> rt.Phase:
    return rt.Phase(rt.load("two_link_arm"), (1, 5), rt.State(q=[0, 0.5], v=0), **more)


def solved() -> rt.Solution:
    return rt.plan(block(), rt.Mesh(4))


def never() -> rt.Ipopt:
    class Never(rt.Ipopt):
        def solve(self, *_: Any) -> Any:
            raise AssertionError("a stage was solved")

    return Never()


def system_of(dynamics: Any, **more: Any) -> Callable[[], Any]:
    return lambda: block(system=rt.System(["x", "v"], ["u"], dynamics, name="block", **more))


def path(expression: Any, **more: Any) -> Callable[[], Any]:
    return lambda: block(constraints=[rt.PathConstraint(expression, **({"upper": 1, "name": "power"} | more))])


def pose(rotation: Any) -> Callable[[], Any]:
    return lambda: cartpole(constraints=[rt.FramePose("tip", ([0, 0, 0], rotation))])


def good(point: Any) -> list[Any]:
    return [point.x["v"], point.u["u"]]


TABLE: dict[str, tuple[Callable[[], Any], type[Exception], list[str]]] = {
    # the ends
    "NaN in the start": (
        lambda: cartpole(start=rt.State(q=[0, NAN], v=0)),
        rt.InputError,
        ["start position", "'pole'", "NaN"],
    ),
    "NaN in a named state": (
        lambda: block(start=rt.State({"v": NAN})),
        rt.InputError,
        ["start state", "'v'", "NaN"],
    ),
    "infinite end": (
        lambda: cartpole(end=rt.State(q=[np.inf, 0])),
        rt.InputError,
        ["end position", "'slider'", "infinite"],
    ),
    "start of the wrong length": (
        lambda: cartpole(start=rt.State(q=[0, 0, 0])),
        rt.InputError,
        ["start position", "3 values", "needs 2", "slider, pole"],
    ),
    "end of the wrong length": (
        lambda: block(end=rt.State([1])),
        rt.InputError,
        ["end state", "1 values", "needs 2", "x, v"],
    ),
    "unknown joint": (
        lambda: cartpole(start=rt.State(q={"pol": 0})),
        rt.UnknownName,
        ["joint", "'pol'", "Did you mean 'pole'?", "start position"],
    ),
    "unknown state": (
        lambda: block(end=rt.State({"y": 1})),
        rt.UnknownName,
        ["state", "'y'", "Valid names: x, v", "end state"],
    ),
    "start outside a limit": (
        lambda: cartpole(start=rt.State(q=[-3, 0], v=0)),
        rt.InputError,
        ["start position", "'slider'", "-3 m", "position limit", "[-2, 2] m", "Move the start"],
    ),
    "end outside a state bound": (
        lambda: block(states={"x": rt.between(-1, 0.5)}),
        rt.InputError,
        ["end state of 'x' is 1, outside its state bound [-1, 0.5]. Move"],
    ),
    "state of a system given as q": (
        lambda: block(start=rt.State(q=[0])),
        rt.InputError,
        ["start of a System", "q=, v= and a= are for robots"],
    ),
    "state of a robot given by position": (
        lambda: cartpole(start=rt.State([0, 0, 0, 0])),
        rt.InputError,
        ["rt.State(q=..., v=...)"],
    ),
    "start that is no State": (
        lambda: block(start=[0, 0]),
        rt.InputError,
        ["start of phase 'phase'", "rt.State"],
    ),
    "a list for one joint": (
        lambda: cartpole(start=rt.State(q={"pole": [0, 1]})),
        rt.InputError,
        ["start position of joint 'pole'", "one number"],
    ),
    "a word for a number": (
        lambda: block(start=rt.State({"x": "far"})),
        rt.InputError,
        ["start state of state 'x'", "'far'"],
    ),
    "text that looks like a number": (
        lambda: block(start=rt.State({"x": "0"})),
        rt.InputError,
        ["start state of state 'x'", "must be a number", "'0'"],
    ),
    # bounds
    "crossed bounds": (lambda: rt.between(2, 1), rt.InputError, ["between(2, 1)", "swap"]),
    "NaN bound": (lambda: rt.between(NAN, 1), rt.InputError, ["between(nan, 1)", "NaN"]),
    "a word for a bound": (lambda: rt.between("low", 1), rt.InputError, ["between('low', 1)", "numbers"]),
    "text that looks like a bound": (lambda: rt.between("1", 2), rt.InputError, ["between('1', 2)", "numbers"]),
    "bounds of an unknown control": (
        lambda: block(controls={"F": 1}),
        rt.UnknownName,
        ["control", "'F'", "Valid names: u"],
    ),
    "bounds that contradict each other": (
        lambda: cartpole(constraints=[rt.constraints.JointPosition({"pole": rt.between(7, 9)})], end=None),
        rt.InputError,
        ["position limit, pole", "[7, 9] rad", "[-6.28319, 6.28319]"],
    ),
    "bounds of a constant": (
        lambda: block(constraints=[rt.PathConstraint(lambda point: 2.0, upper=1, name="two")]),
        rt.InputError,
        ["two is 2", "[-inf, 1]"],
    ),
    # durations
    "negative duration": (
        lambda: block(duration=-1.0),
        rt.InputError,
        ["duration of phase 'phase'", "-1.0", "above 0"],
    ),
    "no duration": (lambda: block(duration=None), rt.InputError, ["duration of phase 'phase'", "None"]),
    "duration fixed at zero by bounds": (
        lambda: block(duration=(0, 0)),
        rt.InputError,
        ["duration of phase 'phase'", "(0, 0)", "above 0"],
    ),
    "crossed durations": (
        lambda: block(duration=(3, 0.5)),
        rt.InputError,
        ["duration of phase 'phase'", "(3, 0.5)"],
    ),
    "NaN duration": (lambda: block(duration=NAN), rt.InputError, ["duration", "NaN"]),
    "a word for a duration": (lambda: block(duration="long"), rt.InputError, ["duration", "'long'"]),
    "text that looks like a duration": (
        lambda: block(duration="1"),
        rt.InputError,
        ["duration of phase 'phase'", "'1'", "seconds above 0", "(least, greatest)"],
    ),
    "text that looks like durations": (
        lambda: block(duration=("1", "2")),
        rt.InputError,
        ["duration of phase 'phase'", "('1', '2')", "numbers"],
    ),
    "a truth value for a duration": (lambda: block(duration=True), rt.InputError, ["duration", "True", "seconds"]),
    "a mapping for a duration": (
        lambda: block(duration={"duration": 1.0}),
        rt.InputError,
        ["duration of phase 'phase'", "{'duration': 1.0}", "seconds"],
    ),
    "three durations": (lambda: block(duration=[1, 2, 3]), rt.InputError, ["duration", "[1, 2, 3]", "(least"]),
    "one duration in a list": (lambda: block(duration=[1.0]), rt.InputError, ["duration", "[1.0]", "seconds"]),
    "an array of no dimension for a duration": (
        lambda: block(duration=np.array(1.0)),
        rt.InputError,
        ["duration", "array(1.)", "seconds"],
    ),
    "impossible duration": (
        lambda: cartpole(limits=rt.load("cartpole").limits.with_(velocity={"pole": 1.0})),
        rt.InputError,
        ["joint 'pole'", "3.142 rad", "1 rad/s", "2 s", "at least 3.142 s"],
    ),
    # robots
    "root glued": (lambda: rt.load("acrobot", root="glued"), rt.UnknownName, ["'glued'", "fixed, floating, planar"]),
    "free-flyer and a fixed root": (
        lambda: rt.load(pin.buildSampleModelHumanoidRandom(), root="fixed"),
        rt.InputError,
        ["free joint 'root_joint'", "root='fixed'", "root='floating'"],
    ),
    "quaternion that is none": (
        lambda: (
            rt.Phase(
                rt.load("acrobot", root="floating"), 1.0, start=rt.State(q=[0, 0, 0, 0, 0, 0, 2, 0, 0])
            ).start_bounds
        ),
        rt.InputError,
        ["start position", "(0, 0, 0, 2)", "length 2"],
    ),
    "zero for all of a floating root": (
        lambda: rt.Phase(rt.load("acrobot", root="floating"), 1.0, end=rt.State(q=0)).end_bounds,
        rt.InputError,
        ["end position", "(0, 0, 0, 0)", "length 0"],
    ),
    "quaternion within too little": (
        lambda: (
            rt.Phase(
                rt.load("acrobot", root="floating"), 1.0, start=rt.State(q={"root_qx": 0.9, "root_qy": 0.9})
            ).start_bounds
        ),
        rt.InputError,
        ["start position", "length 1"],
    ),
    "motor at the root": (
        lambda: rt.load("acrobot", root="planar", actuated=["root_x"]),
        rt.UnknownName,
        ["'root_x'", "shoulder, elbow"],
    ),
    "joint of a floating root by its joint": (
        lambda: rt.Phase(rt.load("acrobot", root="floating"), 1.0, start=rt.State(q={"root_joint": 0})).start_bounds,
        rt.UnknownName,
        ["'root_joint'", "root_qw"],
    ),
    "position limit of a floating root": (
        lambda: rt.load("acrobot", root="floating", limits={"position": {"root_vz": (0, 1)}}),
        rt.InputError,
        ["floating root", "rt.constraints.JointPosition"],
    ),
    "unknown robot": (lambda: rt.load("acrobat"), rt.UnknownName, ["'acrobat'", "'acrobot'"]),
    "unknown motor": (lambda: rt.load("acrobot", actuated=["elbo"]), rt.UnknownName, ["'elbo'", "'elbow'"]),
    "limits of zero": (
        lambda: rt.Phase(rt.load("double_pendulum"), 1.0),
        rt.InputError,
        ["Phase 'phase'", "limit", "0"],
    ),
    "limits of a system": (
        lambda: block(limits=rt.load("block").limits),
        rt.InputError,
        ["limits=", "Systems use states="],
    ),
    "limits that are no Limits": (
        lambda: cartpole(limits={"pole": 1}),
        rt.InputError,
        ["limits=", "robot.limits.with_"],
    ),
    "nothing that moves": (lambda: rt.Phase("cartpole", 1.0), rt.InputError, ["rt.load(...)", "str"]),
    # constraints
    "unknown frame": (
        lambda: cartpole(constraints=[rt.GroundClearance("tp", 0)]),
        rt.UnknownName,
        ["frame", "'tp'", "'tip'"],
    ),
    "clearance violated at the fixed start": (
        lambda: cartpole(constraints=[rt.GroundClearance("tip", 5)]),
        rt.InputError,
        ["at the start", "ground clearance, tip", "[5, inf] m", "Move the start"],
    ),
    "matrix that is no rotation": (
        pose(2 * np.eye(3)),
        rt.InputError,
        ["pose of frame 'tip'", "not a rotation"],
    ),
    "reflection": (pose(np.diag([1.0, 1, -1])), rt.InputError, ["pose of frame 'tip'", "not a rotation"]),
    "quaternion that is not normalised": (
        pose([0, 0, 0, 2]),
        rt.InputError,
        ["frame 'tip'", "norm 2", "normalise"],
    ),
    "Pinocchio's quaternion, not normalised": (
        pose(pin.Quaternion(2.0, 0, 0, 0)),
        rt.InputError,
        ["frame 'tip'", "norm 2", "normalise"],
    ),
    "rotation of a wrong shape": (pose(np.eye(2)), rt.InputError, ["frame 'tip'", "(2, 2)", "(3, 3)"]),
    "frame position that bounds nothing": (
        lambda: cartpole(constraints=[rt.FramePosition("tip", [None, None, None])]),
        rt.InputError,
        ["FramePosition of 'tip'", "free"],
    ),
    "clearance in a system": (
        lambda: block(constraints=[rt.GroundClearance("tip")]),
        rt.InputError,
        ["GroundClearance needs a robot", "PathConstraint"],
    ),
    "clearance of NaN": (
        lambda: cartpole(constraints=[rt.GroundClearance("tip", NAN)]),
        rt.InputError,
        ["tip", "height is nan"],
    ),
    "ground that is no ground": (
        lambda: cartpole(constraints=[rt.GroundClearance("tip", 0, 3.0)]),
        rt.InputError,
        ["ground", "rt.terrain.Flat", "3.0"],
    ),
    "expression that returns text": (
        path(lambda point: "fast"),
        rt.InputError,
        ["expression of constraint 'power'", "CasADi", "str"],
    ),
    "expression that returns nothing": (
        path(lambda point: None),
        rt.InputError,
        ["expression of constraint 'power'", "NoneType"],
    ),
    "expression that reads an unknown state": (
        path(lambda point: point.x["w"]),
        rt.UnknownName,
        ["state", "'w'", "Valid names: x, v"],
    ),
    "expression that reads an unknown parameter": (
        path(lambda point: point.p["m"]),
        rt.UnknownName,
        ["parameter", "'m'"],
    ),
    "expression that indexes a joint that is not there": (
        lambda: arm(constraints=[rt.PathConstraint(lambda point: point.q[9], lower=0, name="power")]),
        rt.InputError,
        ["Phase 'phase'", "constraint 'power'", "out of bounds with supplied length of 2", "1 argument"],
    ),
    "expression with max": (
        path(lambda point: max(point.u["u"], 0)),
        rt.InputError,
        ["Phase 'phase'", "constraint 'power'", "truth value", "casadi.fmax"],
    ),
    "expression with if": (
        path(lambda point: 1 if point.u["u"] > 0 else 0),
        rt.InputError,
        ["Phase 'phase'", "constraint 'power'", "truth value", "casadi.if_else"],
    ),
    "expression that is no function": (path(3.0), rt.InputError, ["constraint 'power'", "'float'", "not callable"]),
    "expression at one end that fails": (
        lambda: block(constraints=[rt.AtEnd(rt.PathConstraint(lambda point: point.w, upper=1, name="power"))]),
        rt.InputError,
        ["Phase 'phase'", "constraint 'power'", "AttributeError", "'w'"],
    ),
    "expression of an integral that fails": (
        lambda: block(
            constraints=[rt.constraints.IntegralConstraint(lambda point: min(point.u["u"], 0), upper=1, name="work")]
        ),
        rt.InputError,
        ["Phase 'phase'", "constraint 'work'", "casadi.fmin"],
    ),
    "clearance function that fails": (
        lambda: cartpole(constraints=[rt.GroundClearance("tip", lambda point: max(point.q[0], 0))]),
        rt.InputError,
        ["Phase 'phase'", "height function", "casadi.fmax"],
    ),
    "foothold of a swing that fails": (
        lambda: cartpole(
            constraints=[rt.GroundClearance("tip", rt.constraints.SwingApex(0.1, 0.0, lambda point: point.q[9]))]
        ),
        rt.InputError,
        ["Phase 'phase'", "rt.constraints.SwingApex", "out of bounds"],
    ),
    "path constraint that bounds nothing": (
        path(good, upper=None),
        rt.InputError,
        ["'power'", "lower= or upper="],
    ),
    "path constraint with crossed bounds": (
        path(good, lower=2, upper=1),
        rt.InputError,
        ["'power'", "2", "above", "1"],
    ),
    "path constraint with a wrong number of bounds": (
        path(good, upper=[1, 2, 3]),
        rt.InputError,
        ["'power'", "2 rows", "3 values"],
    ),
    "constraint that is none": (lambda: block(constraints=[3]), rt.InputError, ["3", "not a constraint"]),
    "AtEnd of no constraint": (lambda: rt.AtEnd(3), rt.InputError, ["AtEnd", "3", "constraint"]),
    # objectives
    "objective that is none": (
        lambda: block(objective="time"),
        rt.InputError,
        ["objective of phase 'phase'", "rt.Effort()"],
    ),
    "objectives in a list": (lambda: block(objective=[rt.Duration()]), rt.InputError, ["Add its terms with +"]),
    "objective that is a function": (
        lambda: block(objective=lambda point: point.u["u"] ** 2),
        rt.InputError,
        ["Give a function to rt.Lagrange or rt.Mayer"],
    ),
    "objective without parentheses": (
        lambda: block(objective=rt.Duration),
        rt.InputError,
        ["objective of phase 'phase'", "rt.Effort()"],
    ),
    "Lagrange expression that fails": (
        lambda: cartpole(objective=rt.Lagrange(lambda point: point.q[9])),
        rt.InputError,
        ["Phase 'phase'", "Lagrange expression of the objective", "out of bounds"],
    ),
    "Mayer expression of one point": (
        lambda: block(objective=rt.Duration() + rt.Mayer(lambda end: end.x["v"])),
        rt.InputError,
        ["Phase 'phase'", "Mayer expression of the objective", "TypeError", "2 arguments"],
    ),
    "reference that fails": (
        lambda: block(objective=rt.objectives.Tracking(lambda t: {"x": max(t, 1), "v": 0})),
        rt.InputError,
        ["Phase 'phase'", "reference of Tracking", "casadi.fmax"],
    ),
    "objective times a word": (lambda: rt.Duration() * "two", rt.InputError, ["finite number", "'two'"]),
    "effort with too many weights": (
        lambda: cartpole(objective=rt.Effort([1, 2, 3])),
        rt.InputError,
        ["Effort", "3 weights", "slider"],
    ),
    "effort of an unactuated joint": (
        lambda: cartpole(objective=rt.Effort({"pole": 1})),
        rt.UnknownName,
        ["'pole'", "slider", "Effort"],
    ),
    "negative effort": (lambda: arm(objective=rt.Effort([1, -1])), rt.InputError, ["'elbow'", "-1"]),
    "effort with a word for a weight": (
        lambda: arm(objective=rt.Effort({"elbow": "low"})),
        rt.InputError,
        ["'elbow'", "'low'"],
    ),
    "Mayer term that reads a control": (
        lambda: block(objective=rt.Mayer(lambda start, end: end.u["u"])),
        rt.InputError,
        ["control", "'u'"],
    ),
    "Mayer term that reads accelerations": (
        lambda: cartpole(objective=rt.Mayer(lambda start, end: end.a[0])),
        rt.InputError,
        ["Accelerations", "end points"],
    ),
    "Lagrange term of two values": (
        lambda: block(objective=rt.Lagrange(good)),
        rt.InputError,
        ["Lagrange", "one scalar", "2"],
    ),
    # systems
    "dynamics of the wrong number": (
        system_of(lambda point: [point.x["v"]]),
        rt.InputError,
        ["dynamics of 'block'", "1 values", "must return 2"],
    ),
    "dynamics that return text": (
        system_of(lambda point: ["v", "u"]),
        rt.InputError,
        ["dynamics of 'block'", "str"],
    ),
    "dynamics that fail": (
        system_of(lambda point: [point.x["v"], max(point.u["u"], 0)]),
        rt.InputError,
        ["Phase 'phase'", "dynamics of 'block'", "casadi.fmax"],
    ),
    "residual that fails": (
        system_of(good, algebraic=["z"], residual=lambda point: [point.z["z"] + [0.0][1]]),
        rt.InputError,
        ["Phase 'phase'", "residual of 'block'", "IndexError"],
    ),
    "missing residual": (system_of(good, algebraic=["z"]), rt.InputError, ["'block'", "residual", "missing"]),
    "residual of the wrong number": (
        system_of(good, algebraic=["z"], residual=lambda point: [point.z["z"], 0]),
        rt.InputError,
        ["residual of 'block'", "2 values", "must return 1"],
    ),
    "missing dynamics": (lambda: rt.System(["x"]), rt.InputError, ["'system'", "dynamics="]),
    "a name used twice": (lambda: rt.System(["x"], ["x"], good), rt.InputError, ["'x'", "twice"]),
    "names given as one word": (
        lambda: rt.System("xv", ["u"], good),
        rt.InputError,
        ["states", "list of names", "'xv'"],
    ),
    "unit of an unknown variable": (
        lambda: rt.System(["x"], ["u"], good, units={"y": "m"}),
        rt.UnknownName,
        ["'y'", "units="],
    ),
    # problems, meshes, guesses, solvers
    "no phase": (lambda: rt.Problem([]), rt.InputError, ["has no phase"]),
    "link to a missing phase": (
        lambda: rt.Problem([block()], [rt.Continuity(0, 1)]),
        rt.InputError,
        ["Continuity(0, 1)", "phase 1", "0 to 0"],
    ),
    "link between other states": (
        lambda: rt.Problem([block(), cartpole()], [rt.Continuity(0, 1)]),
        rt.InputError,
        ["Continuity(0, 1)", "'x'", "'q.slider'", "same"],
    ),
    "link whose expression takes one phase too few": (
        lambda: rt.Problem([block(), block()], [rt.links.Linkage((0, 1), lambda a: a.end.x["v"], name="hand over")]),
        rt.InputError,
        ["link 'hand over'", "TypeError", "2 arguments"],
    ),
    "link that is none": (
        lambda: rt.Problem([block()], ["continuity"]),
        rt.InputError,
        ["'continuity'", "rt.Continuity"],
    ),
    "mesh of no interval": (lambda: rt.Mesh(0), rt.InputError, ["a whole number from 1", "0"]),
    "mesh of half an interval": (lambda: rt.Mesh(2.5), rt.InputError, ["whole number", "2.5"]),
    "knots that do not ascend": (lambda: rt.Mesh([0, 0.6, 0.5, 1]), rt.InputError, ["ascend", "0.6, 0.5"]),
    "knots that do not reach the end": (lambda: rt.Mesh([0, 0.5]), rt.InputError, ["from 0 to 1", "0.5"]),
    "scheme without parentheses": (
        lambda: rt.Mesh(10, rt.HermiteSimpson),
        rt.InputError,
        ["rt.HermiteSimpson()", "parentheses"],
    ),
    "fewer schemes than intervals": (
        lambda: rt.Mesh(3, [rt.schemes.Trapezoidal(), rt.HermiteSimpson()]),
        rt.InputError,
        ["3 intervals", "2 schemes"],
    ),
    "Lobatto scheme of one point": (
        lambda: rt.schemes.LobattoIIIA(points=1),
        rt.InputError,
        ["at least 2 points", "1"],
    ),
    "trapezoidal quadrature of a Radau scheme": (
        lambda: rt.plan(block(), rt.Mesh(4, rt.schemes.RadauIIA(quadrature=rt.schemes.TrapezoidalQuadrature()))),
        rt.InputError,
        ["TrapezoidalQuadrature", "Lobatto"],
    ),
    "two meshes for one phase": (
        lambda: rt.plan(block(), [rt.Mesh(2), rt.Mesh(2)]),
        rt.InputError,
        ["1 phases", "2 meshes"],
    ),
    "mesh that is none": (lambda: rt.plan(block(), 40), rt.InputError, ["mesh=", "rt.Mesh"]),
    "constraint on the start where the scheme has no point": (
        lambda: rt.plan(
            block(constraints=[rt.AtStart(rt.PathConstraint(lambda point: point.u["u"] ** 2, upper=1))]),
            rt.Mesh(2, rt.schemes.RadauIIA()),
        ),
        rt.InputError,
        ["'phase'", "start", "RadauIIA", "Lobatto"],
    ),
    "limit on the start where the scheme has no point": (
        lambda: rt.plan(
            arm(constraints=[rt.AtStart(rt.constraints.JointEffort(0.0))]), rt.Mesh(2, rt.schemes.RadauIIA())
        ),
        rt.InputError,
        ["'phase'", "start", "RadauIIA", "Lobatto"],
    ),
    "problem that is none": (lambda: rt.plan(double_integrator()), rt.InputError, ["rt.Problem", "System"]),
    "guess that is none": (
        lambda: rt.plan(block(), guess=[0, 1]),
        rt.InputError,
        ["guess", "rt.guess.StraightLine()", "list"],
    ),
    "guessed duration outside its bounds": (
        lambda: rt.plan(block(), guess=rt.guess.StraightLine(duration=50)),
        rt.InputError,
        ["50", "'phase'", "0.1 to 20"],
    ),
    "keyframes without fractions": (
        lambda: rt.guess.Keyframes([0, 1], [rt.State([0, 0])]),
        rt.InputError,
        ["Keyframes", "2 fractions", "1 states"],
    ),
    "keyframes that do not ascend": (
        lambda: rt.guess.Keyframes([0, 0.5, 0.2, 1], [rt.State([0, 0])] * 4),
        rt.InputError,
        ["Keyframes", "ascend"],
    ),
    "solver that is none": (
        lambda: rt.plan(block(), solver="ipopt"),
        rt.InputError,
        ["solver=", "rt.Ipopt()", "'ipopt'"],
    ),
    "solver without parentheses": (
        lambda: rt.plan(block(), solver=rt.Ipopt),
        rt.InputError,
        ["solver=", "rt.Ipopt()"],
    ),
    "tolerance that is text": (
        lambda: rt.plan(block(), tolerance="1e-3"),  # type: ignore[arg-type]
        rt.InputError,
        ["tolerance=", "between 0 and 1", "'1e-3'"],
    ),
    "unknown option of the solver": (
        lambda: rt.plan(block(), solver=rt.Ipopt(options={"tool": 1})),
        rt.InputError,
        ["IPOPT", "tool"],
    ),
    "tolerance of zero": (lambda: rt.Ipopt(tolerance=0), rt.InputError, ["tolerance", "above 0"]),
    # solutions
    "time outside the solution": (
        lambda: solved().at(99),
        rt.InputError,
        ["t = 99 s", "'phase'", "from 0 s to"],
    ),
    "NaN for a time": (lambda: solved().at(NAN), rt.InputError, ["t = nan s"]),
    "times in a matrix": (lambda: solved().at([[0.0, 1.0]]), rt.InputError, ["vector", "(1, 2)"]),
    "unknown state of a sample": (
        lambda: solved().at(0).x["speed"],
        rt.UnknownName,
        ["'speed'", "Valid names: x, v"],
    ),
    "one stage without a list": (
        lambda: rt.plan(block(), continuation=rt.planning.ContinuationStep()),
        rt.InputError,
        ["continuation=", "rt.planning.ContinuationStep", "got ContinuationStep"],
    ),
    "stage on a number of intervals": (
        lambda: rt.planning.ContinuationStep(mesh=3),
        rt.InputError,
        ["ContinuationStep(mesh)", "rt.Mesh", "3"],
    ),
    "stage with a solver's name": (
        lambda: rt.planning.ContinuationStep(solver="ipopt"),
        rt.InputError,
        ["ContinuationStep(solver)", "rt.Ipopt()", "'ipopt'"],
    ),
    "second stage that cannot be posed": (
        lambda: rt.plan(
            block(),
            solver=never(),
            continuation=[rt.planning.ContinuationStep(), rt.planning.ContinuationStep(objective=3)],
        ),
        rt.InputError,
        ["objective", "rt.Effort()"],
    ),
    "refinement that is none": (
        lambda: rt.plan(block(), tolerance=1e-3, refinement=3),
        rt.InputError,
        ["refinement=", "rt.refinement.SplitOrRaise()", "3"],
    ),
    "refinement of a mesh given alone": (
        lambda: rt.plan(block(), rt.Mesh(5), refinement=rt.refinement.SplitOrRaise()),
        rt.InputError,
        ["refinement=", "tolerance="],
    ),
    "fallback by a solver's name": (
        lambda: rt.InteriorPoint(fallback="ipopt"),
        rt.InputError,
        ["InteriorPoint(fallback)", "rt.Ipopt()", "'ipopt'"],
    ),
    "options that are a number": (
        lambda: rt.Ipopt(options=3),
        rt.InputError,
        ["Ipopt(options)", "mapping", "3"],
    ),
    "first barrier that is zero": (
        lambda: rt.InteriorPoint(initial_barrier=0.0),
        rt.InputError,
        ["initial_barrier", "above 0", "0.0"],
    ),
    "factor of the barrier below zero": (
        lambda: rt.InteriorPoint(barrier_factor=-1.0),
        rt.InputError,
        ["barrier_factor", "above 0", "-1.0"],
    ),
    "parameters without names": (
        lambda: block().with_(parameters=3),
        rt.InputError,
        ["parameters=", "'phase'", "mapping", "int"],
    ),
    "bounds of controls without names": (
        lambda: block().with_(controls=[1]),
        rt.InputError,
        ["controls=", "mapping", "list"],
    ),
    "no constraints as None": (
        lambda: block().with_(constraints=None),
        rt.InputError,
        ["constraints=", "[] for none", "NoneType"],
    ),
    "contacts that are a number": (
        lambda: cartpole().with_(contacts=3),
        rt.InputError,
        ["contacts=", "list of contacts", "int"],
    ),
    "phases that are a number": (
        lambda: rt.Problem(3),
        rt.InputError,
        ["phases", "rt.Phase", "int"],
    ),
    "no links as None": (
        lambda: rt.Problem([block()], None),
        rt.InputError,
        ["links", "[] for none", "NoneType"],
    ),
    "unknown field of a problem of two phases": (
        lambda: rt.Problem([block(), block()]).with_(goal=1),
        rt.UnknownName,
        ["field of a phase", "'goal'", "start, end"],
    ),
    "guess from a problem": (
        lambda: rt.guess.FromSolution(rt.Problem([block()])),
        rt.InputError,
        ["FromSolution", "Solution", "got Problem"],
    ),
    "file that is a number": (
        lambda: rt.load_solution(3),
        rt.InputError,
        ["rt.load_solution", "path", "int"],
    ),
    "file's problem that is a solution": (
        lambda: rt.load_solution("plan.npz", problem=solved()),
        rt.InputError,
        ["problem=", "rt.Problem", "got Solution"],
    ),
    "tolerance between the points in words": (
        lambda: rt.interval_limits.ConstraintGeneration("fine"),
        rt.InputError,
        ["ConstraintGeneration(tolerance)", "above 0", "'fine'"],
    ),
    "half a round": (
        lambda: rt.interval_limits.BernsteinBounds(rounds=1.5),
        rt.InputError,
        ["BernsteinBounds(rounds)", "whole number", "1.5"],
    ),
    **{
        f"{name} of a problem": (
            partial(function, rt.Problem([block()]), *more),
            rt.InputError,
            [name, "takes a solution", "got Problem"],
        )
        for name, function, *more in (
            ("rt.validate", rt.validate),
            ("rt.witness.track", rt.witness.track, 1.0, 1.0),
            ("rt.witness.second_opinion", rt.witness.second_opinion),
            ("rt.replay", rt.replay, "plan.html"),
            ("rt.indirect.costates", rt.indirect.costates),
            ("rt.indirect.conditions", rt.indirect.conditions),
            ("rt.indirect.polish", rt.indirect.polish),
            ("rt.indirect.cut_at_junctions", rt.indirect.cut_at_junctions),
        )
    },
    "proof of many starts": (
        lambda: rt.validate(rt.applications.Multistart((), {}, 3, 0, 1e-5, 1e-2)),
        rt.InputError,
        ["rt.validate", "got Multistart", ".best"],
    ),
    "interval that the plan has not": (
        lambda: solved().phases[0].at(0, interval=9),
        rt.InputError,
        ["interval 9", "0 to 3"],
    ),
}


@pytest.mark.parametrize("name", TABLE)
def test_bad_input_meets_one_clear_error(name: str) -> None:
    provoke, kind, parts = TABLE[name]
    with pytest.raises(kind) as caught:
        provoke()
    message = str(caught.value)
    missing = [part for part in parts if part not in message]
    assert not missing, f"{message!r} lacks {missing}"
    assert "\n" not in message and message[-1] in ".?", message


def test_the_good_phases_that_the_table_spoils_are_good() -> None:
    assert rt.plan(block(), rt.Mesh(4)).success
    assert rt.plan(cartpole(), rt.Mesh(10)).success


def test_errors_are_the_packages_own_and_values_errors() -> None:
    assert issubclass(rt.InputError, rt.RobotrajError) and issubclass(rt.InputError, ValueError)
    assert issubclass(rt.UnknownName, rt.InputError)


@pytest.mark.parametrize(
    ("call", "remedy"),
    [
        (lambda: cartpole(constraints=[rt.obstacles.Sphere(0.1, position=(1, 1, 1))]), "rt.CollisionFree([...])"),
        (lambda: cartpole(objective=rt.Effort), "Call it: rt.Effort()."),
        (lambda: cartpole(end=rt.State(q={"pole": "180deg"})), "np.radians(90)"),
        (lambda: rt.plan([cartpole(), cartpole()]), "rt.sweep plans each"),
        (lambda: rt.plan(cartpole(), mesh=40), "rt.Mesh(40)"),
        (lambda: rt.plan(rt.load("cartpole")), "A motion of it is rt.Phase(robot, duration, start="),
        (lambda: cartpole(constraints=[rt.Effort()]), "It is minimised: objective= takes it."),
        (lambda: rt.override(rt.plan(cartpole(), rt.Mesh(10)), 30), "30 percent are 0.3."),
        (lambda: rt.retime([{"q": 0}, {"q": 1}], rt.load("pendulum")), "got a list of dict entries."),
        (lambda: rt.Waypoints(rt.load("cartpole"), np.zeros((2, 3))), "an array of shape (3,). The places are a list"),
        (lambda: rt.robot.join({"a": rt.load("ur5"), "b": rt.load("ur5")}, at=(1, 0, 0)), "at= gives poses by"),
        (lambda: rt.FramePose("tip", np.array(TRANSPOSED)), "The transposed matrix, pose.T, has this row."),
        (
            lambda: cartpole(constraints=[rt.FramePose("tip", (0.4, 0.2, 0.3, 0, 0, 0, 1))]),
            "XYZQUATToSE3(pose)",
        ),
        (lambda: cartpole(constraints=[rt.FramePose("tip", (0.4, 0.2, 0.3, 0, 3.14, 0))]), "rpyToMatrix(*rpy)"),
        (lambda: rt.plan(cartpole(), rt.Mesh(10)).to_controller("x.yaml", rate=0.001), "a period of 1 ms is rate=1000"),
        (lambda: rt.plan(cartpole(), rt.Mesh(10)).to_csv("motion.xlsx"), "let it end in .csv"),
        (lambda: rt.replay(rt.plan(cartpole(), rt.Mesh(10)), "motion.gif"), "menu Save makes videos, GIFs"),
    ],
)
def test_an_error_says_what_the_caller_wanted(call: Callable[[], object], remedy: str) -> None:
    with pytest.raises(rt.InputError) as found:
        call()
    assert remedy in str(found.value)


def test_values_that_a_solution_has_at_times_are_said_to_be_there() -> None:
    solution = rt.plan(cartpole(), rt.Mesh(10))
    with pytest.raises(AttributeError, match=r"no attribute 'q'. Read values at times: solution.at\(t\).q"):
        _ = solution.q
    with pytest.raises(AttributeError, match=r"no attribute 'trajectory'. Read values at times: solution.at\(t\).q"):
        _ = solution.trajectory
    with pytest.raises(AttributeError, match="no attribute 'wings'.$"):
        _ = solution.wings
