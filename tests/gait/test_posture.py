"""The default objective of gaits: its price of haste against closed forms, and free durations inside their bounds."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.gait.posture import HASTE, SHARE

WIDE = (0.03, 2.0)


def worth(robot: rt.Robot, standing: np.ndarray) -> tuple[float, float]:
    """Return w [N^2 m^2] and h / g [s^2], written again."""
    h = pin.centerOfMass(robot.model, robot.model.createData(), standing)[2]
    return (SHARE * robot.mass * 9.81 * h) ** 2, h / 9.81


def test_a_phase_at_rest_lasts_as_long_as_its_rate_allows(solo: rt.Robot) -> None:
    """The rest c T + A / T is least where both parts are equal: T = sqrt(A / c), at a cost of 2 A / T."""
    rest = rt.State(q=gait.stand(solo), v=0.0)
    support = gait.Support(gait.feet_of(solo, None), WIDE, "stand")
    solution = rt.plan(
        gait.sequence(solo, [support], gait.GaitTerms(), None, rest, rest), mesh=rt.Mesh(4), progress=False
    )
    w, pendulum = worth(solo, gait.stand(solo))
    price, time = HASTE * w * pendulum, solution.duration
    assert WIDE[0] < 0.9 * time and time < 0.9 * WIDE[1]
    assert solution.objective == pytest.approx(2.0 * price / time, rel=0.01)
    tau = solution.at(0.5 * time).tau
    assert time == pytest.approx(np.sqrt(price / (tau @ tau)), rel=0.05)


def test_the_price_of_a_fixed_duration_is_constant(biped: rt.Robot) -> None:
    """0.16 w (h / g) / T is added to the objective, and the motion remains."""
    posture = gait.stand(biped)
    options = {"step_length": 0.3, "duration": 0.6}
    plain, dear = (
        rt.plan(gait.walk(biped, objective=cost, **options), mesh=rt.Mesh(6), progress=False)
        for cost in (rt.Effort(), rt.Effort() + gait.haste(biped, posture))
    )
    w, pendulum = worth(biped, posture)
    assert dear.objective - plain.objective == pytest.approx(HASTE * w * pendulum / 0.6, rel=1e-6)
    assert dear.at(0.3).q == pytest.approx(plain.at(0.3).q, abs=1e-5)


def test_planar_robots_have_the_price_at_rest_where_a_duration_is_free(biped: rt.Robot) -> None:
    rest = rt.State(q=gait.stand(biped), v=0.0)
    feet = gait.feet_of(biped, None)

    def cost(duration: float | tuple[float, float], ends: rt.State | None, own: rt.Effort | None = None) -> object:
        repeat = rt.Periodic() if ends is None else None
        support = gait.Support(feet, duration, "stand")
        return gait.sequence(biped, [support], gait.GaitTerms(objective=own), repeat, ends, ends).phases[0].objective

    posture = gait.stand(biped)
    assert cost((0.3, 0.9), rest) == gait.posture_objective(biped, posture) + gait.haste(biped, posture)
    assert cost(0.6, rest) == cost((0.3, 0.9), None) == cost((0.3, 0.9), rest, rt.Effort()) == rt.Effort()


def test_phases_of_fixed_duration_have_no_price(solo: rt.Robot) -> None:
    """The objective of a gait with fixed durations has the three terms of ``gait_objective`` alone."""
    fixed, free = (gait.trot(solo, step_length=0.06, duration=span).phases[0] for span in (0.2, (0.2, 0.4)))
    plain = gait.gait_objective(solo, gait.stand(solo))
    assert len(fixed.objective.parts) == len(plain.parts) == 3  # type: ignore[union-attr]
    assert len(free.objective.parts) == 4  # type: ignore[union-attr]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bolt", "solo", "biped"])
def test_free_durations_of_all_phases_end_inside_their_bounds(name: str, request: pytest.FixtureRequest) -> None:
    """Steps from rest to rest in which each stance and each swing has its own free duration."""
    robot = request.getfixturevalue(name)
    feet = gait.feet_of(robot, None)
    pair = feet[:1] if len(feet) == 2 else (feet[0], feet[3])
    other = tuple(foot for foot in feet if foot not in pair)
    supports = [gait.Support(each, WIDE, str(i)) for i, each in enumerate((feet, pair, feet, other, feet))]
    first = gait.stand(robot)
    last = np.array(first)
    last[0] += 0.25 * pin.centerOfMass(robot.model, robot.model.createData(), first)[2]
    terms = gait.GaitTerms(upright=gait.Upright())
    problem = gait.sequence(robot, supports, terms, None, rt.State(q=first, v=0.0), rt.State(q=last, v=0.0))
    solution = rt.plan(problem, progress=False)
    assert solution.proof.holds
    assert all(1.2 * WIDE[0] < part.duration < 0.8 * WIDE[1] for part in solution.phases)
