"""The crawl as a problem, and its plan from the default guess."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.gait.posture import FixedPosture

FEET = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")


def swinging(problem: rt.Problem) -> list[list[str]]:
    return [
        [foot for foot in FEET if foot not in {contact.frame for contact in phase.contacts}] for phase in problem.phases
    ]


def test_hind_then_fore_foot_of_one_side_then_its_mirror_image(dog: rt.Robot) -> None:
    problem = gait.crawl(dog, step_length=0.05, duration=0.5)
    assert swinging(problem) == [["HL_FOOT"], ["FL_FOOT"]]
    assert [type(link) for link in problem.links] == [rt.Continuity, rt.Mirror]
    assert problem.links[-1].displacement == {"q.root_x": 0.05}
    right = gait.crawl(dog, step_length=0.05, duration=0.5, feet=["HR_FOOT", "HL_FOOT", "FL_FOOT", "FR_FOOT"])
    assert swinging(right) == [["HR_FOOT"], ["FR_FOOT"]]


def test_all_feet_stand_for_their_share(dog: rt.Robot) -> None:
    problem = gait.crawl(dog, step_length=0.05, duration=(0.5, 1.0), full_support=0.2)
    assert swinging(problem) == [[], ["HL_FOOT"], ["FL_FOOT"]]
    assert [phase.duration_bounds for phase in problem.phases] == [
        pytest.approx(b) for b in ((0.1, 0.2),) + ((0.2, 0.4),) * 2
    ]
    assert [type(link) for link in problem.links] == [
        rt.links.Liftoff,
        rt.Continuity,
        rt.Mirror,
        rt.links.Linkage,
        rt.links.Linkage,
    ]


def test_periodic_writes_four_swings(dog: rt.Robot) -> None:
    problem = gait.crawl(dog, step_length=0.05, duration=0.5, repeat=rt.Periodic())
    assert swinging(problem) == [["HL_FOOT"], ["FL_FOOT"], ["HR_FOOT"], ["FR_FOOT"]]
    assert problem.links[-1].displacement == {"q.root_x": 0.1}


def test_robots_that_cannot_crawl_are_refused(dog: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="needs 4 feet"):
        gait.crawl(rt.load("five_link", root="planar"), step_length=0.1, duration=0.5)
    with pytest.raises(rt.InputError, match=r"full_support. is 1.0"):
        gait.crawl(dog, step_length=0.1, duration=0.5, full_support=1.0)
    with pytest.raises(rt.InputError, match="two feet on each side"):
        gait.crawl(dog, step_length=0.1, duration=0.5, feet=["FL_FOOT", "HL_FOOT", "HR_FOOT", "HR_LOWER_LEG"])
    with pytest.raises(rt.InputError, match="two of step_length="):
        gait.crawl(dog, step_length=0.1)


@pytest.mark.slow
def test_solo_crawls_from_its_own_guess(dog: rt.Robot) -> None:
    still = FixedPosture(tuple(gait.stand(dog).tolist()))
    posture = rt.objectives.Tracking(still, q=dict.fromkeys(dog.joint_names[-dog.nu :], 1.0))
    problem = gait.crawl(
        dog, step_length=0.05, duration=0.5, full_support=0.1, clearance=0.03, objective=0.1 * rt.Effort() + posture
    )
    solution = rt.plan(problem, mesh=[rt.Mesh(n, rt.HermiteSimpson()) for n in (1, 6, 6)])
    assert solution.iterations < 60
    data = dog.model.createData()

    def place(foot: str, t: float) -> np.ndarray:
        pin.framesForwardKinematics(dog.model, data, solution.at(t).q)
        return np.array(data.oMf[dog.frame(foot)].translation)

    end = solution.duration
    for foot, other in (("HL_FOOT", "HR_FOOT"), ("FL_FOOT", "FR_FOOT")):
        # Two step lengths ahead; the other foot is at the mirror image of its place in the first half.
        first, last = place(foot, 0.0), place(foot, end)
        np.testing.assert_allclose(last[0] - first[0], 0.1, atol=1e-4)
        stood = place(other, 0.25)
        np.testing.assert_allclose(stood, [0.5 * (first[0] + last[0]), -first[1], 0.0], atol=1e-4)
        assert max(place(foot, t)[2] for t in np.linspace(0.0, end, 101)) > 0.0299
    times = np.linspace(0.0, end, 101)
    forces = solution.at(times).forces
    for foot in FEET:
        fx, fy, fz = forces[foot].T
        assert np.all(np.hypot(fx, fy) <= 0.7 * fz + 1e-2)
