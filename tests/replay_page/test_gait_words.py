"""The page names a repeating gait by its feet and its speed."""

import robotraj as rt
from robotraj.replay_page.gait_words import gait_words
from robotraj.solution.cycles.gait_cycles import gait_cycles


def words(problem: rt.Problem | rt.Phase) -> str:
    """Words for what a few iterations give: the footholds are those of the problem."""
    solution = rt.plan(problem, mesh=rt.Mesh(4), solver=rt.InteriorPoint(max_iterations=60), check=False)
    return gait_words(gait_cycles(solution, 1))


def test_a_trot_has_diagonal_pairs_and_the_speed_of_its_steps() -> None:
    solo12 = rt.load("solo12", root="floating")
    assert words(rt.gait.trot(solo12, step_length=0.1, duration=0.3)) == "trot at 0.33 m/s"


def test_two_feet_walk() -> None:
    five_link = rt.load("five_link", root="planar")
    assert words(rt.gait.walk(five_link, step_length=0.5, duration=0.7)) == "walk at 0.71 m/s"


def test_a_plan_that_does_not_repeat_has_no_gait() -> None:
    cart = rt.load("cartpole")
    move = rt.Phase(cart, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, 0], v=0), rt.Effort())
    assert words(move) == ""
