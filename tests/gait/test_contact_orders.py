"""Orders of contacts: in a stride each foot swings once, all orders move on as far, and the cheapest is found."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

import robotraj as rt
from robotraj import gait


def planned(problem: rt.Problem) -> tuple[float, float]:
    """Return displacement [m] and duration [s] of the planned part of a stride."""
    link = problem.links[-1]
    repeat = link.repeat if isinstance(link, rt.Touchdown) else link
    assert isinstance(repeat, rt.Mirror | rt.Periodic)
    return float(repeat.displacement["q.root_x"]), sum(phase.duration_bounds[0] for phase in problem.phases)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["bolt", "dog"])
def test_orders_move_at_one_speed_and_swing_each_foot_once_a_stride(name: str, request: pytest.FixtureRequest) -> None:
    robot = request.getfixturevalue(name)
    found = gait.orders(robot, speed=0.2, stride=0.4)
    feet = set(gait.feet_of(robot, None))
    assert len(found) == (3 if name == "bolt" else 6)
    stands = []
    for problem in found.values():
        length, time = planned(problem)
        assert length / time == pytest.approx(0.2)
        assert time == pytest.approx(0.4) or time == pytest.approx(0.2)
        held = [frozenset(contact.label for contact in phase.contacts) for phase in problem.phases]
        swings = [foot for each in held if 0 < len(each) < len(feet) for foot in feet - each]
        assert len(swings) == len(set(swings)) == (len(feet) if time > 0.3 else len(feet) // 2)
        stands.append(tuple(held))
    assert len(set(stands)) == len(stands)


def test_the_sequences_are_those_of_hildebrand(dog: rt.Robot) -> None:
    """A hind foot is followed by the fore foot on its side, in the diagonal sequence by the other one."""
    found = gait.orders(dog, speed=0.2, stride=0.4)
    every = set(gait.feet_of(dog, None))
    for name, side in (("lateral sequence", True), ("diagonal sequence", False)):
        hind, fore = (
            next(iter(every - {contact.label for contact in phase.contacts})) for phase in found[name].phases[:2]
        )
        assert hind[0] == "H" and fore[0] == "F" and (hind[1] == fore[1]) is side


def test_orders_that_no_leg_can_do_are_left_out_or_named(dog: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="m/s at most|m at most"):
        gait.orders(dog, speed=30.0, stride=0.4)
    with pytest.raises(rt.InputError, match="orders of two and of four feet"):
        gait.orders(dog, speed=0.2, stride=0.4, feet=["FL_FOOT", "FR_FOOT", "HL_FOOT"])
    with pytest.raises(rt.InputError, match="stride"):
        gait.orders(dog, speed=0.2, stride=0.0)


@pytest.mark.slow
def test_the_cheapest_order_of_a_dog_is_proved_and_costs_least(dog: rt.Robot) -> None:
    orders = gait.orders(dog, speed=0.2, stride=0.3)
    with ThreadPoolExecutor(1) as here:
        found = rt.applications.cheapest(orders, executor=here)
    assert found.solution.proof is not None and found.solution.proof.holds
    by_hand = {
        name: each.objective / (each.at(each.duration).q[0] - each.at(0.0).q[0])
        for name, each in found.found.items()
        if isinstance(each, rt.Solution)
    }
    assert found.best == min(by_hand, key=lambda name: by_hand[name])
    assert len(by_hand) == 6 and found.costs["trot with flight"] > found.costs["trot"]
