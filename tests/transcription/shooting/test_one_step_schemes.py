"""One-step schemes: exact derivatives, defects of the integrator, and refused problems."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.added_rows import with_added_rows
from robotraj.transcription.interval_limits.row_places import AddedRow
from tests.programs import nlp_of

SCHEMES = {
    "multiple, constant": rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(2)),
    "multiple, linear": rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(2), control=rt.schemes.LinearControl()),
    "single, constant": rt.schemes.SingleShooting(rt.schemes.RungeKutta4(2)),
    "single, linear": rt.schemes.SingleShooting(rt.schemes.RungeKutta4(2), control=rt.schemes.LinearControl()),
    "compressed": rt.schemes.CompressedHermiteSimpson(),
    "compressed, linear": rt.schemes.CompressedHermiteSimpson(control=rt.schemes.LinearControl()),
}
ADAPTIVE = {
    "multiple, adaptive": rt.schemes.MultipleShooting(rt.schemes.Adaptive(1e-12)),
    "single, adaptive": rt.schemes.SingleShooting(rt.schemes.Adaptive(1e-12), control=rt.schemes.LinearControl()),
}
KNOTS = [0, 0.3, 0.5, 1]


def rates(t: float, x: Array, u: float, mass: float) -> list[float]:
    return [x[1], (u + 0.3 * t) / mass - np.sin(x[0])]


def phase_of(**more: object) -> rt.Phase:
    """Time, a free duration, a parameter, a bounded state, a row of state and control, costs inside and at the ends."""
    system = rt.System(
        ["q", "w"],
        ["u"],
        lambda point: [point.x["w"], (point.u["u"] + 0.3 * point.t) / point.p["mass"] - ca.sin(point.x["q"])],
    )
    given = {
        "duration": (1.0, 3.0),
        "start": rt.State([0, 0]),
        "end": rt.State([2, None]),
        "objective": rt.Lagrange(lambda point: point.u["u"] ** 2 + point.x["w"] ** 2 * point.t)
        + rt.Mayer(lambda start, end: end.x["w"] ** 2 + end.p["mass"] ** 3),
        "constraints": [rt.PathConstraint(lambda point: point.x["w"] * point.u["u"], upper=9, name="power")],
        "states": {"w": rt.between(-4, 4)},
        "controls": {"u": rt.between(-5, 5)},
        "parameters": {"mass": rt.between(0.5, 2)},
    }
    return rt.Phase(system, **(given | more))


def somewhere(nlp: rt.transcription.Nlp) -> tuple[Array, Array]:
    random = np.random.default_rng(11)
    return nlp.guess + nlp.scale * random.uniform(-0.1, 0.1, len(nlp.guess)), random.normal(size=len(nlp.rows))


def differences(function: Callable[[Array], Array], w: Array, scale: Array, step: float) -> Array:
    def column(i: int, h: float) -> Array:
        e = np.zeros_like(w)
        e[i] = h
        return (function(w + e) - function(w - e)) / (2 * h)

    return np.column_stack([(4 * column(i, h) - column(i, 2 * h)) / 3 for i, h in enumerate(step * scale)])


@pytest.mark.parametrize(
    ("scheme", "within"),
    [(s, 1e-8) for s in SCHEMES.values()] + [(s, 2e-6) for s in ADAPTIVE.values()],
    ids=[*SCHEMES, *ADAPTIVE],
)
def test_derivatives_agree_with_finite_differences(scheme: rt.schemes.MultipleShooting, within: float) -> None:
    nlp = nlp_of(rt.Problem([phase_of()]), rt.Mesh(KNOTS, scheme))
    w, multipliers = somewhere(nlp)
    step = 1e-4 if within < 1e-7 else 1e-3

    def lagrangian_gradient(v: Array) -> Array:
        return 0.7 * nlp.gradient(v) + nlp.jacobian(v).T @ multipliers

    found = [nlp.gradient(w), nlp.jacobian(w).toarray(), nlp.hessian(w, multipliers, 0.7).toarray()]
    expected = [
        differences(lambda v: np.array([nlp.objective(v)]), w, nlp.scale, step).ravel(),
        differences(nlp.values, w, nlp.scale, step),
        differences(lagrangian_gradient, w, nlp.scale, step),
    ]
    for ours, theirs in zip(found, expected, strict=True):
        assert np.any(theirs)
        np.testing.assert_allclose(ours, theirs, atol=within * max(1.0, float(np.max(np.abs(theirs)))))


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_bounds_between_knots_are_the_interpolants_and_share_an_evaluation(scheme: rt.schemes.OneStep) -> None:
    """Of two bounds in one interval and one in another; each once had a place of its own."""
    problem = rt.Problem([phase_of()])
    plain = nlp_of(problem, rt.Mesh(KNOTS, scheme))
    places = [(0, 0.3), (0, 0.7), (2, 0.4)]
    bound = next(row.number for row in problem.phases[0].rows.rows if row.name == "state bound")
    nlp = with_added_rows(plain, [AddedRow(0, k, bound, tau) for k, tau in places], plain.guess)
    assert all(block.count <= 2 for block in nlp.blocks[len(plain.blocks) :])
    w, multipliers = somewhere(nlp)
    (motion,) = extract(plain, w)
    times = [motion.t0 + motion.duration * (KNOTS[k] + (KNOTS[k + 1] - KNOTS[k]) * tau) for k, tau in places]
    np.testing.assert_allclose(nlp.values(w)[len(plain.rows) :], motion.x(np.array(times))[:, 1], atol=1e-12)

    def lagrangian_gradient(v: Array) -> Array:
        return 0.7 * nlp.gradient(v) + nlp.jacobian(v).T @ multipliers

    for ours, theirs in (
        (nlp.jacobian(w).toarray(), differences(nlp.values, w, nlp.scale, 1e-4)),
        (nlp.hessian(w, multipliers, 0.7).toarray(), differences(lagrangian_gradient, w, nlp.scale, 1e-4)),
    ):
        np.testing.assert_allclose(ours, theirs, atol=1e-8 * max(1.0, float(np.max(np.abs(theirs)))))


@pytest.mark.parametrize("scheme", [rt.schemes.MultipleShooting, rt.schemes.SingleShooting])
@pytest.mark.parametrize(
    "control", [rt.schemes.ConstantControl(), rt.schemes.LinearControl()], ids=["constant", "linear"]
)
def test_trajectories_and_costs_are_the_initial_value_problem_s(
    scheme: type, control: rt.schemes.LinearControl
) -> None:
    """Independently integrated by SciPy from the first state, with the found control, duration and parameter."""
    solution = rt.plan(phase_of(), rt.Mesh(KNOTS, scheme(rt.schemes.Adaptive(1e-11), control=control)))
    part = solution.phases[0]
    mass = part.parameters["mass"]
    x, cost = np.array([0.0, 0.0]), 0.0
    for k, (begin, end) in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):

        def every(t: float, y: Array, k: int = k) -> list[float]:
            u = float(part.at(t, interval=k).u["u"])
            return [*rates(t, y, u, mass), u**2 + y[1] ** 2 * t]

        times = np.linspace(begin, end, 9)
        found = solve_ivp(every, (begin, end), [*x, cost], "DOP853", times, rtol=1e-12, atol=1e-12).y
        sample = part.at(times, interval=k)
        np.testing.assert_allclose([sample.x["q"], sample.x["w"]], found[:2], atol=1e-8)
        x, cost = found[:2, -1], found[2, -1]
    assert solution.objective == pytest.approx(cost + x[1] ** 2 + mass**3, abs=1e-8)


def test_a_runge_kutta_defect_is_that_of_the_method() -> None:
    nlp = nlp_of(
        rt.Problem([phase_of(constraints=[])]), rt.Mesh(KNOTS, rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(3)))
    )
    w, _ = somewhere(nlp)
    layout = nlp.layouts[0]
    duration, mass = layout.duration.of(w), layout.parameters[0].of(w)
    expected = []
    for interval in layout.intervals:
        x, u = w[interval.left], float(w[interval.controls[0, 0]])
        h = duration * interval.length / 3
        for i in range(3):
            t = duration * interval.start + i * h

            def f(dt: float, y: Array, t: float = t, u: float = u) -> Array:
                return np.array(rates(t + dt, y, u, mass))

            k1 = f(0, x)
            k2 = f(h / 2, x + h / 2 * k1)
            k3 = f(h / 2, x + h / 2 * k2)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(h, x + h * k3))
        expected.append(w[interval.right] - x)
    np.testing.assert_allclose(nlp.values(w), np.ravel(expected), atol=1e-13)


def test_compressed_and_separated_hermite_simpson_have_one_solution() -> None:
    tight = rt.Ipopt(tolerance=1e-11)
    separated = rt.plan(phase_of(), rt.Mesh(10), solver=tight)
    compressed = rt.plan(phase_of(), rt.Mesh(10, rt.schemes.CompressedHermiteSimpson()), solver=tight)
    assert compressed.objective == pytest.approx(separated.objective, rel=1e-10)
    times = np.linspace(0, 1, 41)
    for name in ("q", "w"):
        one, other = (s.at(times * s.duration).x[name] for s in (separated, compressed))
        np.testing.assert_allclose(one, other, atol=1e-6)


def test_single_shooting_has_no_states_between_the_ends_but_holds_their_rows() -> None:
    problem = rt.Problem(
        [
            phase_of(
                objective=rt.Duration(),
                states={"w": rt.between(-1.5, 1.5)},
                controls={"u": rt.between(-9, 9)},
            )
        ]
    )
    nlp = nlp_of(problem, rt.Mesh(8, rt.schemes.SingleShooting()))
    names = nlp.variable_names
    assert sum("state, w" in name for name in names) == 2
    held = [row.split(", t")[0] for row in nlp.row_names]
    assert held.count("phase: state bound, w") == 7
    # A constant control jumps at knots: the power is held on both sides.
    assert held.count("phase: power") == 2 * 7 + 2
    solution, multiple = (
        rt.plan(problem, rt.Mesh(8, scheme)) for scheme in (rt.schemes.SingleShooting(), rt.schemes.MultipleShooting())
    )
    speed = solution.at(solution.phases[0].knots).x["w"]
    assert np.max(speed) == pytest.approx(1.5, abs=1e-6)
    assert solution.objective == pytest.approx(multiple.objective, rel=1e-7)


HELD_BETWEEN = {
    "multiple": rt.schemes.MultipleShooting(control=rt.schemes.LinearControl()),
    "multiple, adaptive": rt.schemes.MultipleShooting(rt.schemes.Adaptive(), control=rt.schemes.LinearControl()),
    "single": rt.schemes.SingleShooting(control=rt.schemes.LinearControl()),
    "compressed": rt.schemes.CompressedHermiteSimpson(control=rt.schemes.LinearControl()),
}


@pytest.mark.parametrize("as_row", [False, True], ids=["bound", "path row"])
@pytest.mark.parametrize("scheme", HELD_BETWEEN.values(), ids=HELD_BETWEEN)
def test_rows_on_states_are_held_between_knots(scheme: rt.schemes.MultipleShooting, as_row: bool) -> None:
    """At 0.3 s and 0.7 s a block with least effort keeps below 1.4 m/s, half-way it would reach 1.5 m/s."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    row = rt.PathConstraint(lambda point: point.x["v"] ** 2, upper=1.4**2, name="speed squared")
    held = {"constraints": [row]} if as_row else {"states": {"v": rt.between(-1.4, 1.4)}}
    ends = rt.State([0, 0]), rt.State([1, 0])
    phase = rt.Phase(block, 1.0, *ends, rt.Lagrange(lambda point: point.u["u"] ** 2), **held)
    solution = rt.plan(phase, rt.Mesh([0, 0.3, 0.7, 1], scheme))
    speed = solution.at(np.linspace(0, 1, 401)).x["v"]
    assert np.max(speed) == pytest.approx(1.4, abs=1e-3)
    free = rt.plan(rt.Phase(block, 1.0, *ends, phase.objective), rt.Mesh([0, 0.3, 0.7, 1], scheme))
    assert np.max(free.at(np.linspace(0, 1, 401)).x["v"]) > 1.45


def test_knots_move_with_multiple_shooting_onto_the_switching_time() -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(
        block, (1, 9), rt.State([0, 0]), rt.State([1, 0]), rt.Duration(), controls={"u": rt.between(-1, 0.5)}
    )
    solution = rt.plan(phase, rt.schemes.MovingMesh(2, rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(1))))
    # Full ahead for t1, full back for t2: t1 / 2 = t2 and (t1 + t2) t1 / 4 = 1.
    assert solution.duration == pytest.approx(np.sqrt(6), rel=1e-7)
    assert solution.phases[0].knots[1] == pytest.approx(2 * np.sqrt(6) / 3, rel=1e-6)


@pytest.mark.parametrize(
    "scheme",
    [rt.schemes.MultipleShooting(), rt.schemes.SingleShooting(), rt.schemes.CompressedHermiteSimpson()],
    ids=lambda s: type(s).__name__,
)
def test_a_robot_is_planned_by_forward_dynamics_and_proved(scheme: rt.schemes.MultipleShooting) -> None:
    robot = rt.load("pendulum")
    limits = robot.limits.with_(effort=100.0)
    phase = rt.Phase(robot, 2.5, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort(), limits=limits)
    solution = rt.plan(phase, rt.Mesh(20, scheme))
    assert isinstance(solution.phases[0].phase.dynamics, rt.dynamics.ForwardDynamics)
    report = rt.validate(solution)
    assert report.passed, str(report)


def test_phases_of_different_schemes_are_linked() -> None:
    first, second = (
        phase_of(duration=1.0, start=start, end=end, parameters={"mass": 1.0}, name=name)
        for name, start, end in (("first", rt.State([0, 0]), None), ("second", None, rt.State([2, None])))
    )
    problem = rt.Problem([first, second], [rt.Continuity(0, 1)])
    reference = rt.plan(problem, rt.Mesh(10, rt.schemes.GaussLegendre(3)))
    mixed = rt.plan(
        problem,
        [
            rt.Mesh(10, rt.schemes.RadauIIA(3)),
            rt.Mesh(40, rt.schemes.MultipleShooting(control=rt.schemes.LinearControl())),
        ],
    )
    assert mixed.objective == pytest.approx(reference.objective, rel=1e-4)
    np.testing.assert_allclose(mixed.phases[0].at(1.0).x["w"], mixed.phases[1].at(1.0).x["w"], atol=1e-8)


def test_a_shot_solution_survives_the_file(tmp_path: object) -> None:
    robot = rt.load("pendulum")
    phase = rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    solution = rt.plan(phase, rt.Mesh(6, rt.schemes.SingleShooting(control=rt.schemes.LinearControl())))
    again = rt.load_solution(solution.save(f"{tmp_path}/shot.npz"))
    times = np.linspace(0, 1, 13)
    np.testing.assert_array_equal(solution.at(times).q, again.at(times).q)
    np.testing.assert_array_equal(solution.at(times).tau, again.at(times).tau)


DAE = rt.System(
    ["x"],
    ["u"],
    lambda point: [point.z["a"]],
    algebraic=["a"],
    residual=lambda point: [point.z["a"] - point.u["u"]],
)


@pytest.mark.parametrize(
    ("phase", "mesh", "words"),
    [
        (rt.Phase(DAE, 1.0), rt.Mesh(4, rt.schemes.MultipleShooting()), "algebraic variables 'a'"),
        (phase_of(), rt.Mesh(2, [rt.schemes.MultipleShooting(), rt.HermiteSimpson()]), "mixes MultipleShooting"),
        (phase_of(), rt.Mesh(2, [rt.schemes.RadauIIA(), rt.schemes.SingleShooting()]), "mixes SingleShooting"),
        (phase_of(), rt.schemes.MovingMesh(4, rt.schemes.SingleShooting()), "cannot move the knots"),
        (
            phase_of(objective=rt.objectives.AbsolutePower(speeds={"u": "w"})),
            rt.Mesh(4, rt.schemes.MultipleShooting()),
            "slacks at collocation points, which",
        ),
        (
            phase_of(constraints=[rt.constraints.IntegralConstraint(lambda point: point.u["u"] ** 2, upper=9)]),
            rt.Mesh(4, rt.schemes.CompressedHermiteSimpson()),
            "bounds an integral",
        ),
    ],
    ids=["algebraic", "mixed", "mixed, single last", "moving single", "slacks", "integral"],
)
def test_unsupported_problems_are_refused(phase: rt.Phase, mesh: rt.Mesh, words: str) -> None:
    with pytest.raises(rt.InputError, match=words):
        rt.plan(phase, mesh)


def test_bounds_of_accelerations_point_to_the_constraint() -> None:
    robot = rt.load("pendulum")
    joint = robot.joint_names[0]
    phase = rt.Phase(robot, 1.0, algebraic={f"a.{joint}": rt.between(-1, 1)})
    with pytest.raises(rt.InputError, match="rt.constraints.JointAcceleration"):
        nlp_of(rt.Problem([phase]), rt.Mesh(4, rt.schemes.SingleShooting()))


@pytest.mark.parametrize(
    "make",
    [
        lambda: rt.schemes.RungeKutta4(0),
        lambda: rt.schemes.RungeKutta4(1.5),
        lambda: rt.schemes.Adaptive(0.0),
        lambda: rt.schemes.Adaptive(1.0),
    ],
)
def test_integrators_check_their_settings(make: Callable[[], object]) -> None:
    with pytest.raises(rt.InputError):
        make()
