"""Plans with contacts from closed forms: right plans pass, and each error is reported with its place and time."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj._util.errors import ValidationFailed
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.problem.links.touchdown import Touchdown
from robotraj.witness import NumericPoint, track, validate
from robotraj.witness.contacts.stance import Stance
from robotraj.witness.simulation.integration import integrate
from robotraj.witness.simulation.simulate import robot_rates

MASS, INERTIA, HEIGHT = 2.0, 0.05, 0.4
ABOUT_FOOT = INERTIA + MASS * HEIGHT**2
WEIGHT = 9.81 * MASS

ROD = f"""<robot name="rod">
  <link name="rod"><inertial><mass value="{MASS}"/>
    <inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="end" type="fixed"><parent link="rod"/><child link="foot"/><origin xyz="0 0 {-HEIGHT}"/></joint>
  <link name="foot"/>
</robot>"""


@pytest.fixture(scope="module")
def rod(tmp_path_factory: pytest.TempPathFactory) -> rt.Robot:
    """A body in the vertical plane whose centre of mass is ``HEIGHT`` above its foot when it stands upright."""
    path: Path = tmp_path_factory.mktemp("rod") / "rod.urdf"
    path.write_text(ROD)
    return rt.load(str(path), root="planar")


def falling(angle: float, speed: float, duration: float):
    """Let a rod on a fixed foot fall; return (q, v, a, force) at (foot, t)."""

    def rates(t, x):
        return [x[1], MASS * 9.81 * HEIGHT * np.sin(x[0]) / ABOUT_FOOT]

    found = solve_ivp(rates, (0, duration), [angle, speed], method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True)

    def at(t, foot=0.0):
        x, w = found.sol(t)
        alpha = rates(t, [x, w])[1]
        out, across = np.array([np.sin(x), np.cos(x)]), np.array([np.cos(x), -np.sin(x)])
        linear = HEIGHT * (alpha * across - w**2 * out)
        q = np.array([foot, 0.0, x]) + np.append(HEIGHT * out, 0.0)
        v, a = np.append(HEIGHT * w * across, w), np.append(linear, alpha)
        return q, v, a, MASS * (linear + np.array([0.0, 9.81]))

    return at


def stance(make, rod, motion, knots, *, foot=0.0, begin=0.0, anchor=None, friction=0.7, **changes):
    """Plan a stance of the rod on its foot from a motion; curves may be replaced."""
    phase = rt.Phase(rod, duration=knots[-1] - knots[0], contacts=[PointContact("foot", friction)], name="stance")
    curves = {name: (lambda t, k, i=i: motion(t - begin, foot)[i]) for i, name in enumerate(("q", "v", "a", "z"))}
    curves |= {"tau": lambda t, k: np.zeros(0)} | changes
    return make.plan(phase, knots, 10, {"foot.x": foot if anchor is None else anchor}, **curves)


def solution(*planned, links=(), impulses=()):
    """A solution with the attributes that the witness reads."""
    problem = rt.Problem([p.phase for p in planned], links=links)
    return SimpleNamespace(phases=planned, problem=problem, impulses=impulses, success=True, objective=0.0, proof=None)


KNOTS = np.linspace(0.0, 0.4, 9)


def test_a_free_body_on_a_point_contact_is_the_pendulum_it_makes(rod):
    # Hanging from its foot and swinging over many periods: energy and the textbook's angle are kept.
    bound = PointContact("foot").bind(rod)
    held = Stance(rod, [bound], {"foot.x": 0.0})
    motion = falling(np.pi - 1.2, 0.3, 5.0)
    q, v, _, _ = motion(0.0)
    rates = robot_rates(rod, lambda t, k, q, v: np.zeros(0), held.acceleration)
    found = integrate(rates, np.concatenate([q, v]), np.linspace(0, 5, 26), settle=held.settle)
    assert found.failure is None
    data = rod.model.createData()
    energy = [
        pin.computeKineticEnergy(rod.model, data, x[:3], x[3:]) + pin.computePotentialEnergy(rod.model, data, x[:3])
        for x in found.states
    ]
    assert np.ptp(energy) < 1e-8
    expected = np.array([np.concatenate(motion(t)[:2]) for t in found.times])
    np.testing.assert_allclose(found.states, expected, atol=1e-8)
    gaps = [np.abs(held.rows(x[:3], x[3:]).gap).max() for x in found.states]
    assert max(gaps) < 1e-10


def test_forces_of_the_witness_are_those_of_newton(rod):
    bound = PointContact("foot").bind(rod)
    held = Stance(rod, [bound], {"foot.x": 0.0})
    q, v, _, force = falling(0.3, 1.0, 0.1)(0.05)
    for planned in (np.zeros(2), force, np.array([3.0, -7.0])):
        found, unique = held.forces(q, v, np.zeros(3), held.rows(q, v), {"foot": planned})
        np.testing.assert_allclose(found, force, atol=1e-9)
        assert unique


def test_an_exact_stance_passes(make, rod):
    report = validate(solution(stance(make, rod, falling(0.1, 0.0, 0.4), KNOTS)))
    (holding,) = report.holdings
    assert report.passed and report.failure is None
    assert (holding.contact, holding.phase) == ("foot", "stance")
    assert max(holding.slip.value, holding.sink.value) < 1e-9 and holding.turn.value == 0.0
    assert holding.planned == holding.solved == ()
    assert holding.difference.value < 1e-7
    assert report.local.largest("q.") < 1e-8 and report.drift.largest("q.") < 1e-8
    (landing,) = report.landings
    assert (landing.contact, landing.time) == ("foot", 0.0) and landing.moved < 1e-11
    assert max(peak.value for peak in report.residual.dynamics.values()) < 1e-7
    text = str(report)
    assert "none violated, at or between the knots" in text


def test_a_foot_that_slides_between_two_knots_is_named_with_its_time(make, rod):
    motion = falling(0.1, 0.0, 0.4)

    def sliding(t, k):
        begin, end = KNOTS[k], KNOTS[k + 1]
        bump = 3e-4 * np.sin(np.pi * (t - begin) / (end - begin)) ** 2 if k == 5 else 0.0
        return motion(t)[0] + np.array([bump, 0.0, 0.0])

    report = validate(solution(stance(make, rod, motion, KNOTS, q=sliding)))
    (holding,) = report.holdings
    assert holding.slip.value == pytest.approx(3e-4, rel=1e-2) and holding.slip.time == pytest.approx(0.275, abs=0.002)
    assert holding.sink.value < 1e-8
    with pytest.raises(
        ValidationFailed, match=r"Contact 'foot' slips: by 0\.0003 m at t = 0\.27\d* s in phase 'stance'"
    ):
        report.check()
    # A foot that slides moves the whole robot: its motion is wrong by as much.
    report.check(contact=4e-4, local=1e-2, torques=0.1)


def test_sink_and_slip_of_a_foot_are_separate_figures(make, rod):
    motion = falling(0.1, 0.0, 0.4)
    low = stance(make, rod, motion, KNOTS, q=lambda t, k: motion(t)[0] - np.array([0.0, 2e-3, 0.0]))
    (holding,) = validate(solution(low)).holdings
    assert holding.sink.value == pytest.approx(2e-3, abs=1e-9) and holding.slip.value < 1e-9
    beside = stance(make, rod, motion, KNOTS, anchor=0.02)
    report = validate(solution(beside))
    (holding,), (landing,) = report.holdings, report.landings
    assert holding.slip.value == pytest.approx(0.02, abs=1e-9) and holding.sink.value < 1e-9
    # The simulation holds the foot at its own place, not at the planned one.
    assert landing.distance == pytest.approx(0.02, abs=1e-9)
    assert report.drift.largest("q.") < 1e-8


def test_friction_that_does_not_do_is_found_in_planned_and_in_solved_forces(make, rod):
    motion = falling(0.1, 0.0, 0.4)
    times = np.linspace(0, 0.4, 4001)
    force = np.array([motion(t)[3] for t in times])
    excess = np.abs(force[:, 0]) - 0.1 * force[:, 1]
    report = validate(solution(stance(make, rod, motion, KNOTS, friction=0.1)))
    (holding,) = report.holdings
    worst, again = holding.planned[0], holding.solved[0]
    for found in (worst, again):
        assert found.name.startswith("friction cone") and found.joint == "foot"
        assert found.amount == pytest.approx(excess.max(), rel=1e-3)
        assert found.time == pytest.approx(times[np.argmax(excess)], abs=0.005)
    with pytest.raises(
        ValidationFailed, match=r"violates its limits: friction cone.*, foot, t = 0\.4 s: .*of the weight"
    ):
        report.check()
    report.check(forces=1.01 * excess.max() / WEIGHT)


def test_a_planned_force_that_is_not_the_one_that_acts_differs_and_breaks_the_dynamics(make, rod):
    motion = falling(0.1, 0.0, 0.4)
    wrong = stance(make, rod, motion, KNOTS, z=lambda t, k: motion(t)[3] + np.array([0.0, 0.3]))
    report = validate(solution(wrong))
    (holding,) = report.holdings
    assert holding.difference.value == pytest.approx(0.3, abs=1e-6)
    assert report.residual.dynamics["root_z"].value == pytest.approx(0.3, abs=1e-6)
    # The motion is right: the simulation solves for its own contact forces.
    assert report.drift.largest("q.") < 1e-8


@pytest.fixture
def landing(make, rod):
    """The rod falls freely, strikes with its foot, and topples: (flight, stance, link, impulse)."""
    angle, spin, sideways, down, flight = 0.15, -0.4, 0.2, 1.2, 0.15
    knots = np.linspace(0.0, flight, 4)

    def free(t):
        left = flight - t
        out = np.array([np.sin(angle), np.cos(angle)])
        place = HEIGHT * out + np.array([-sideways * left, down * left - 0.5 * 9.81 * left**2])
        # Velocity at the end (sideways, -down); gravity acts before it.
        rate = np.array([sideways, -down + 9.81 * left])
        return (
            np.append(place, angle - spin * left),
            np.append(rate, spin),
            np.array([0.0, -9.81, 0.0]),
        )

    phase = rt.Phase(rod, duration=flight, name="flight")
    curves = {name: (lambda t, k, i=i: free(t)[i]) for i, name in enumerate(("q", "v", "a"))}
    before = make.plan(phase, knots, 10, tau=lambda t, k: np.zeros(0), z=lambda t, k: np.zeros(0), **curves)
    # About the foot angular momentum is kept: I w + m HEIGHT (v . across).
    across = np.array([np.cos(angle), -np.sin(angle)])
    momentum = INERTIA * spin + MASS * HEIGHT * across @ np.array([sideways, -down])
    after = momentum / ABOUT_FOOT
    impulse = MASS * (HEIGHT * after * across - np.array([sideways, -down]))
    motion = falling(angle, after, 0.2)
    standing = stance(make, rod, motion, np.linspace(flight, flight + 0.2, 5), begin=flight)
    return before, standing, Touchdown(0, 1), dict(zip(("impulse.foot.x", "impulse.foot.z"), impulse, strict=True))


def test_an_exact_landing_passes(landing):
    flight, standing, link, impulse = landing
    report = validate(solution(flight, standing, links=[link], impulses=[impulse]))
    (impact,) = report.impacts
    assert report.passed
    assert impact.time == pytest.approx(0.15) and impact.momentum.value < 1e-9 and impact.rest.value < 1e-9
    assert impact.solved == pytest.approx(impulse, abs=1e-9)
    assert impact.lost > 0.5
    # The simulation solves its own impact: no planned jump is added.
    assert report.drift.largest("q.") < 1e-8 and report.drift.largest("v.") < 1e-7
    assert [landing.phase for landing in report.landings] == ["stance"] and report.landings[0].distance < 1e-9
    assert "Touchdown(0, 1) at t = 0.15 s" in str(report)


def test_an_impulse_that_does_not_keep_momentum_is_refused(landing):
    flight, standing, link, impulse = landing
    wrong = {**impulse, "impulse.foot.z": impulse["impulse.foot.z"] + 0.05}
    report = validate(solution(flight, standing, links=[link], impulses=[wrong]))
    (impact,) = report.impacts
    assert impact.momentum.name == "v.root_z" and impact.momentum.value == pytest.approx(0.05, abs=1e-9)
    with pytest.raises(ValidationFailed, match=r"does not conserve momentum: v\.root_z by 0\.05 N s"):
        report.check()


def test_an_impulse_outside_its_cone_is_refused(make, rod, landing):
    flight, standing, link, impulse = landing
    size = abs(impulse["impulse.foot.x"]) / impulse["impulse.foot.z"]
    slippery = rt.Phase(
        rod, duration=standing.phase.duration, contacts=[PointContact("foot", 0.5 * size)], name="stance"
    )
    standing = dataclasses.replace(standing, phase=slippery)
    report = validate(solution(flight, standing, links=[link], impulses=[impulse]))
    (violation,) = report.impacts[0].broken
    assert violation.name == "impulse friction cone" and violation.unit == "N s"
    assert violation.amount == pytest.approx(0.5 * abs(impulse["impulse.foot.x"]), abs=1e-9)
    with pytest.raises(ValidationFailed, match="violates a limit: impulse friction cone, foot"):
        report.check()


def test_a_wrong_flight_drifts_through_the_landing_but_the_stance_by_itself_does_not(make, rod, landing):
    flight, standing, link, impulse = landing
    q, tilted = flight.curves["q"], []
    for values in q.values:
        tilted.append(values + np.array([0.0, 4e-3, 0.0]))
    moved = dataclasses.replace(flight, curves={**flight.curves, "q": dataclasses.replace(q, values=tilted)})
    report = validate(solution(moved, standing, links=[link], impulses=[impulse]))
    # It touches down 4 mm too high and is held there; the plan of the stance is right.
    assert report.landings[0].distance == pytest.approx(4e-3, abs=1e-8)
    assert report.drift["q.root_z"].largest >= 4e-3 - 1e-8
    # The local error is the jump between the phases, and nothing within them.
    assert report.local["q.root_z"].largest == pytest.approx(4e-3, abs=1e-8)
    assert report.local["q.root_z"].time == pytest.approx(0.15)
    assert validate(solution(standing)).local["q.root_z"].largest < 1e-8


@pytest.mark.parametrize(
    ("friction", "length", "row", "amount"),
    [
        (0.2, 0.4, "friction cone", WEIGHT * (np.sin(0.3) - 0.2 * np.cos(0.3))),
        (0.5, 0.2, "centre of pressure", WEIGHT * (HEIGHT * np.sin(0.3) - 0.1 * np.cos(0.3))),
        (0.5, 0.4, None, 0.0),
    ],
)
def test_a_body_on_a_slope_slides_or_tips_by_what_is_missing(make, rod, friction, length, row, amount):
    # Standing square on a slope that falls towards +x by 0.3 rad, its foot at the origin.
    ground = rt.terrain.Slope(-np.tan(0.3), 0.0)
    contact = FlatFoot("foot", length=length, friction=friction, ground=ground)
    phase = rt.Phase(rod, duration=0.2, contacts=[contact], name="stand")
    (bound,) = phase.bound_contacts
    q = np.array([HEIGHT * np.sin(0.3), HEIGHT * np.cos(0.3), 0.3])
    # World axes: the ground carries the weight; its moment at the foot keeps the body from falling over.
    carried = np.array([0.0, WEIGHT, -WEIGHT * q[0]])
    assert [force.name for force in bound.forces] == ["force.foot.x", "force.foot.z", "force.foot.my"]
    planned = make.plan(
        phase, [0.0, 0.1, 0.2], 4, {"foot.x": 0.0}, q=lambda t, k: q, v=lambda t, k: np.zeros(3),
        a=lambda t, k: np.zeros(3), tau=lambda t, k: np.zeros(0), z=lambda t, k: carried,
    )  # fmt: skip
    report = validate(solution(planned))
    (holding,) = report.holdings
    assert max(holding.slip.value, holding.sink.value, holding.turn.value) < 1e-12
    assert holding.difference.value < 1e-10
    if row is None:
        assert report.passed, report.failures(report.tolerances)
        assert holding.planned == holding.solved == ()
        return
    (violation,), (solved,) = holding.planned, holding.solved
    assert row in violation.name and row in solved.name
    assert violation.amount == pytest.approx(amount, rel=1e-9) and solved.amount == pytest.approx(amount, rel=1e-9)
    assert not report.passed


def test_tracking_holds_contacts_too(landing):
    flight, standing, link, impulse = landing
    followed = track(solution(flight, standing, links=[link], impulses=[impulse]), kp=[], kd=[])
    assert followed.failure is None
    assert followed.error.largest("q.") < 1e-7


def test_a_body_that_slides_on_a_contact_that_comes_and_goes_loses_its_energy_to_friction(make):
    # mu m g brakes a mass on the ground: x = v0 t - mu g t^2 / 2.
    model = pin.Model()
    x = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "x")
    z = model.addJoint(x, pin.JointModelPZ(), pin.SE3.Identity(), "z")
    model.appendBodyToJoint(z, pin.Inertia(2.0, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("body", z, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    mu, speed, brake = 0.4, 2.0, 0.4 * 9.81
    contact = rt.contacts.ImplicitContact("body", friction=mu, relaxation=1e-6)
    phase = rt.Phase(rt.load(model, actuated=[]), duration=0.3, contacts=[contact], limits=None, name="slide")
    (bound,) = phase.bound_contacts
    # Normal force, friction along +x and -x, slipping speed.
    assert [tuple(direction) for direction in bound.directions] == [(1, 0, 0), (-1, 0, 0)]
    sliding = make.plan(
        phase, np.linspace(0, 0.3, 4), 6,
        q=lambda t, k: [speed * t - 0.5 * brake * t**2, 0.0], v=lambda t, k: [speed - brake * t, 0.0],
        a=lambda t, k: [-brake, 0.0], tau=lambda t, k: np.zeros(0),
        z=lambda t, k: [2.0 * 9.81, 0.0, mu * 2.0 * 9.81, speed - brake * t],
    )  # fmt: skip
    report = validate(solution(sliding))
    assert report.passed and report.landings == ()
    assert report.drift.largest("q.") < 1e-9
    assert max(peak.value for peak in report.residual.dynamics.values()) < 1e-9
    assert report.energy.dissipated == pytest.approx(2.0 * 9.81 * mu * (speed * 0.3 - 0.5 * brake * 0.3**2), rel=1e-9)
    assert abs(report.energy.imbalance) < 1e-9
    faster = make.plan(
        phase, np.linspace(0, 0.3, 4), 6, **{name: curve for name, curve in sliding.curves.items() if name != "z"},
        z=lambda t, k: [2.0 * 9.81, 0.0, 1.2 * mu * 2.0 * 9.81, speed - brake * t],
    )  # fmt: skip
    (holding,) = validate(solution(faster)).holdings
    assert "friction cone" in {violation.name for violation in holding.planned}


SOLE = "left_sole_link"


@pytest.mark.parametrize(
    "contact",
    [
        rt.PointContact(SOLE, offset=(0.1, 0.02, 0.0)),
        rt.FlatFoot(SOLE, length=0.2, width=0.1),
        rt.contacts.LineContact(SOLE, width=0.1),
        rt.contacts.LoopClosure(SOLE, "right_sole_link", rigid=True),
    ],
    ids=lambda contact: type(contact).__name__,
)
def test_rows_of_every_contact_are_linear_forms_of_the_velocities(contact):
    robot = rt.load("talos_legs", root="floating")
    bound = contact.bind(robot)
    held = Stance(robot, [bound], {anchor.name: 0.1 for anchor in bound.anchors})
    rng = np.random.default_rng(5)
    q = pin.integrate(robot.model, np.array(robot.neutral), rng.uniform(-0.3, 0.3, robot.nv))
    v, force = rng.normal(size=robot.nv), rng.normal(size=len(bound.forces))
    rows = held.rows(q, v)
    still, moving = (NumericPoint(robot, 0.0, q, v, a, np.zeros(robot.nu)) for a in (np.zeros(robot.nv), v))
    np.testing.assert_allclose(rows.jacobian @ v, bound.velocity(still), atol=1e-12)
    np.testing.assert_allclose(rows.bias, bound.acceleration(still), atol=1e-12)
    np.testing.assert_allclose(rows.jacobian @ v + rows.bias, bound.acceleration(moving), atol=1e-11)
    # The wrenches do the power of the forces on the rows.
    np.testing.assert_allclose(held.torques(q, {bound.name: force}), rows.jacobian.T @ force, atol=1e-12)


def test_a_plan_with_numbers_missing_is_reported_not_raised(make, rod, landing):
    flight, standing, link, impulse = landing
    for part in (flight, standing):
        q = part.curves["q"]
        values = [q.values[0], *(np.full_like(value, np.nan) for value in q.values[1:])]
        lost = dataclasses.replace(part, curves={**part.curves, "q": dataclasses.replace(q, values=values)})
        phases = [lost if planned is part else planned for planned in (flight, standing)]
        report = validate(solution(*phases, links=[link], impulses=[impulse]))
        assert not report.passed
        assert "FAILED" in str(report)
    (holding,) = report.holdings
    assert holding.slip.value == np.inf and holding.slip.time == pytest.approx(0.2)
