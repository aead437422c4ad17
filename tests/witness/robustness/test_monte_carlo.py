"""Runs with disturbances: seeded, nested, exact without disturbances, and counted honestly."""

from dataclasses import astuple, dataclass, replace

import numpy as np
import pytest

import robotraj as rt

mujoco = pytest.importorskip("mujoco")

CALM = rt.witness.Disturbances(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def swing():
    cartpole = rt.load("cartpole")
    phase = rt.Phase(cartpole, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0), rt.Effort())
    return rt.plan(phase)


def test_without_disturbances_the_plan_is_followed(swing):
    found = rt.witness.monte_carlo(swing, runs=1, disturbances=CALM, rate=4000.0)
    assert found.worst[0] < 2e-3  # torques are held for a quarter of a millisecond
    coarse = rt.witness.monte_carlo(swing, runs=1, disturbances=CALM, rate=1000.0)
    assert 2.0 < coarse.worst[0] / found.worst[0] < 8.0  # and err by the length of the period


def test_a_seed_repeats_its_runs_and_more_runs_keep_the_first(swing):
    few, more = (rt.witness.monte_carlo(swing, runs=runs, seed=7) for runs in (2, 4))
    np.testing.assert_array_equal(few.deviations, more.deviations[:2])
    other = rt.witness.monte_carlo(swing, runs=2, seed=8)
    assert not np.array_equal(few.deviations, other.deviations)


def test_the_torque_that_the_feedback_asks_for_grows_with_the_disturbances(swing):
    usual = rt.witness.Disturbances()
    # Without disturbances, torques that are held for a period use 0.004 of the reserve: smaller ones would not show.
    small, large = (rt.witness.monte_carlo(swing, runs=3, disturbances=usual.scaled(f)).used for f in (0.03, 0.12))
    np.testing.assert_allclose(large, 4.0 * small, rtol=0.1)
    assert np.all((large > 0.0) & (large < 1.0))


def test_second_opinion_makes_runs_with_disturbances(swing):
    report = rt.witness.second_opinion(swing, runs=2, bound=0.3, seed=7)
    alone = rt.witness.monte_carlo(swing, runs=2, bound=0.3, seed=7)
    np.testing.assert_array_equal(report.robustness.deviations, alone.deviations)
    assert str(alone).splitlines()[0] in str(report)
    assert rt.witness.second_opinion(swing).robustness is None


@pytest.mark.slow
def test_an_unstable_plan_is_held_by_its_gains(swing):
    found = rt.witness.monte_carlo(swing, runs=40, bound=0.3)
    assert found.held >= 0.95
    low, high = found.interval
    assert low < found.held <= high <= 1.0
    assert f"{int(found.held * 40)} of 40 runs" in str(found)
    assert len(found.plot().axes[0].lines) == 4


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("position", 0.01),
        ("velocity", 0.1),
        ("mass", 0.1),
        ("position_noise", 1e-2),
        ("velocity_noise", 0.1),
        ("push", 0.1),
        ("delay", 5e-3),
    ],
)
def test_every_disturbance_acts(swing, name, size):
    calm = rt.witness.monte_carlo(swing, runs=1, disturbances=CALM)
    found = rt.witness.monte_carlo(swing, runs=1, disturbances=replace(CALM, **{name: size}))
    assert found.worst[0] > 1.5 * calm.worst[0]


def test_friction_acts():
    arm = rt.load("z1")
    q = 0.5 * (arm.limits.position_lower + arm.limits.position_upper)
    plan = rt.plan(rt.Phase(arm, 1.0, rt.State(q=q, v=0), rt.State(q=q + 0.3, v=0), rt.Effort()), mesh=rt.Mesh(20))
    calm, rough = (
        rt.witness.monte_carlo(plan, runs=1, disturbances=replace(CALM, friction=size)) for size in (0.0, 0.5)
    )
    assert not np.array_equal(calm.deviations, rough.deviations)


def test_torques_are_clipped_by_the_limits_of_their_phase():
    """The first phase rests under a small limit, which once clipped the second one, that lifts."""
    pendulum = rt.load("pendulum")
    weak, strong = (pendulum.limits.with_(effort=effort) for effort in (0.5, 20.0))
    rest = rt.Phase(pendulum, 0.2, rt.State(q=0, v=0), rt.State(q=0, v=0), rt.Effort(), limits=weak, name="rest")
    lift = rt.Phase(pendulum, 1.0, None, rt.State(q=np.pi / 2, v=0), rt.Effort(), limits=strong, name="lift")
    plan = rt.plan(rt.Problem([rest, lift], [rt.Continuity(0, 1)]), mesh=rt.Mesh(20))
    assert np.abs(plan.phases[1].at(plan.phases[1].knots).tau).max() > 2.0
    assert rt.witness.monte_carlo(plan, runs=1, disturbances=CALM).worst[0] < 0.02
    report = rt.witness.second_opinion(plan)
    assert report.saturated == 0.0 and report.failure is None


def test_a_large_disturbance_is_not_held(swing):
    hit = rt.witness.Disturbances(position=1.0)
    found = rt.witness.monte_carlo(swing, runs=4, disturbances=hit, bound=0.05)
    assert found.held < 0.5
    assert "disturbance_margin" in str(found)
    assert "disturbance_margin" not in str(rt.witness.monte_carlo(swing, runs=1, disturbances=CALM))


@pytest.mark.parametrize(("kept", "low", "high"), [(100, 0.963, 1.0), (99, 0.9455, 0.9982), (50, 0.4038, 0.5962)])
def test_the_interval_is_wilsons(kept, low, high):
    deviations = np.where(np.arange(100) < kept, 0.0, 1.0)[:, None]
    found = rt.witness.MonteCarlo(np.zeros(1), deviations, np.zeros(len(deviations)), 0.5, 0, CALM, "")
    np.testing.assert_allclose(found.interval, (low, high), atol=6e-4)


def test_bad_input(swing):
    with pytest.raises(rt.InputError, match="mass"):
        rt.witness.Disturbances(mass=-0.1)
    with pytest.raises(rt.InputError, match="runs"):
        rt.witness.monte_carlo(swing, runs=0)
    with pytest.raises(rt.InputError, match="bound"):
        rt.witness.monte_carlo(swing, bound=0.0)
    solo = rt.Phase(rt.load("solo12", root="floating"), 0.1, rt.State(v=0), objective=rt.Effort())
    with pytest.raises(rt.InputError, match="fixed root"):
        rt.witness.monte_carlo(rt.plan(solo, mesh=rt.Mesh(2), check=False))


@dataclass(frozen=True)
class Loaded(rt.witness.Disturbances):
    """Every body is heavier by a share, and nothing else is disturbed."""

    share: float = 0.0

    def of_model(self, mujoco, model, rng):
        other = super().of_model(mujoco, model, rng)
        for name in ("body_mass", "body_inertia"):
            getattr(other, name)[:] = (1.0 + self.share) * getattr(model, name)
        return other

    def __post_init__(self):
        """Accept a share below 0."""


@pytest.mark.parametrize("angle", [np.pi / 6, -np.pi / 6])
@pytest.mark.parametrize(("limit", "reserve"), [(1.5, 1.0), (0.5 + 2e-4, 1e-3 * (0.5 + 2e-4))])
def test_the_reserve_is_what_the_plan_leaves_of_the_limit_in_the_feedbacks_direction(angle, limit, reserve):
    """m g c sin q = 0.5 N m leaves limit - 0.5 to lift and limit + 0.5 to lower; a thousandth of the limit at least."""
    pendulum = rt.load("pendulum")
    level = rt.State(q=angle, v=0)
    rest = rt.Lagrange(lambda point: (point.q[0] - angle) ** 2 + (point.tau[0] - np.sin(angle)) ** 2)
    hold = rt.Phase(pendulum, 1.0, level, level, rest, limits=pendulum.limits.with_(effort=limit))
    plan = rt.plan(hold, mesh=rt.Mesh(20))
    heavier, lighter = (
        rt.witness.monte_carlo(plan, runs=1, disturbances=Loaded(*astuple(CALM), share)).used[0]
        for share in (1e-4, -1e-4)
    )
    assert heavier / lighter == pytest.approx((limit + 0.5) / reserve, rel=1e-2)


def test_a_run_that_diverges_is_infinitely_far_from_then_on(swing):
    wild = replace(CALM, push=1e300)
    found = rt.witness.monte_carlo(swing, runs=2, disturbances=wild)
    assert not np.isnan(found.deviations).any()
    assert np.isinf(found.deviations[:, -1]).all() and found.held == 0.0
    assert "0 of 2 runs" in str(found)


@pytest.mark.parametrize("duration", [0.5, 0.01])
def test_a_push_meets_any_body_at_any_time_at_which_it_can_end(duration):
    rng, size = np.random.default_rng(1), rt.witness.Disturbances(push=3.0)
    drawn = [size.push_of(4, duration, rng) for _ in range(400)]
    bodies, begins, forces = (np.array(each) for each in zip(*drawn, strict=True))
    assert set(bodies) == {1, 2, 3}  # 0 is the world
    last = max(0.0, duration - 0.02)
    assert begins.min() >= 0.0 and 0.95 * last <= begins.max() <= last
    assert np.std(0.02 * forces) == pytest.approx(3.0, rel=0.1)


def test_the_funnel_draws_percentiles_of_the_runs_at_each_time():
    """Ten runs at k times t: the median is 4.5 t, nine tenths lie below 8.1 t, all below 9 t."""
    times = np.array([0.0, 1.0, 2.0])
    runs = np.arange(10.0)[:, None] * times
    figure = rt.witness.MonteCarlo(times, runs, np.zeros(10), 20.0, 0, CALM, "").plot()
    curves = [line.get_ydata() for line in figure.axes[0].lines]
    for curve, share in zip(curves, (4.5, 8.1, 9.0), strict=False):
        np.testing.assert_allclose(curve, share * times)
    np.testing.assert_array_equal(curves[3], 20.0)
