"""Names that do not exist: those of like spelling or like meaning are offered wherever users write names."""

import pytest

import robotraj as rt
from robotraj._util.names.near_words import near_names

CART = rt.load("cartpole")
UR5 = rt.load("ur5")
MOVE = rt.Phase(CART, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, 0], v=0), rt.Effort())
SOLUTION = rt.plan(MOVE, mesh=rt.Mesh(5))
TWO = [[0.0] * 6, [0.1] * 6]

MISTAKES = {
    "Phase named 'goal'. Did you mean 'end'": lambda: rt.Phase(CART, 2.0, goal=rt.State(v=0)),
    "Phase named 'obstacles'. Did you mean 'constraints'": lambda: rt.Phase(CART, 2.0, obstacles=[]),
    "State named 'velocity'. Did you mean 'v'": lambda: rt.State(velocity=0),
    "Box named 'center'. Did you mean 'position'": lambda: rt.obstacles.Box((1, 1, 1), center=(0, 0, 0)),
    "rt.retime named 'velocity'. Did you mean 'limits'": lambda: rt.retime(TWO, UR5, velocity=1.0),
    "rt.retime named 'duration'. Valid names": lambda: rt.retime(TWO, UR5, duration=3.0),
    "rt.retime named 'tolerence'. Did you mean 'tolerance'": lambda: rt.retime(TWO, UR5, tolerence=1e-6),
    "robot named 'franka'. Did you mean 'panda'": lambda: rt.load("franka"),
    "name in robotraj named 'plann'. Did you mean 'plan'": lambda: rt.plann,
    "name in robotraj named 'solve'. Did you mean 'solvers' or 'plan'": lambda: rt.solve,
    "'Solution' object has no attribute 'durations'. Did you mean 'duration'": lambda: SOLUTION.durations,
    "'JointSample' object has no attribute 'torque'. Did you mean 'tau'": lambda: SOLUTION.at(0.1).torque,
}


MISTAKES |= {
    "Did you mean rt.constraints.FrameSpeed?": lambda: rt.FrameSpeed("tool0", linear=0.25),
    "Did you mean rt.constraints.JointJerk?": lambda: rt.JointJerk(500),
    "no name in robotraj named 'MinTime'. Did you mean 'Duration'?": lambda: rt.MinTime(),
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_wrong_name_offers_the_one_that_is_meant(text: str) -> None:
    with pytest.raises(rt.InputError) as caught:
        MISTAKES[text]()
    assert text in str(caught.value)


def test_names_of_like_letters_come_before_those_of_like_meaning() -> None:
    assert near_names("objectve", ["mesh", "objective"]) == ["objective"]
    assert near_names("UR5", ["ur5", "panda"]) == ["ur5"]
    assert near_names("zzz", ["start", "end"]) == []


def test_an_existing_name_is_never_refused_for_another_of_its_meaning() -> None:
    assert rt.State(q=[0, 0], v=0).v == 0
    assert not hasattr(SOLUTION, "torque") and not hasattr(rt, "solve")


@pytest.mark.parametrize("name", ["foot_front_left", "left_front_foot", "FrontLeftFoot", "foot_LF", "fl_foot_link"])
def test_feet_are_found_in_any_order_and_by_the_letters_of_their_corner(name: str) -> None:
    frames = ["root_joint", "FL_hip", "FL_foot", "FR_foot", "RL_foot"]
    assert near_names(name, frames) == ["FL_foot"]
    assert near_names(name.replace("FL", "LF"), ["root_joint", "LF_HIP", "LF_FOOT", "LH_FOOT"]) == ["LF_FOOT"]


def test_names_that_share_few_words_are_not_offered() -> None:
    assert near_names("gripper_left_finger", ["root_joint", "FL_foot", "base_link"]) == []


def test_brackets_behind_a_value_name_the_attribute_that_is_meant() -> None:
    with pytest.raises(rt.InputError, match=r"\['q'\] reads nothing. Read values at times: solution.at\(t\).q."):
        SOLUTION["q"]
    with pytest.raises(rt.InputError, match=r"\['duration'\] reads nothing. Write .duration"):
        SOLUTION["duration"]
    with pytest.raises(rt.InputError, match="Did you mean 'tau'"):
        SOLUTION.at(0.1)["torque"]
    with pytest.raises(TypeError, match="no entries"):
        list(SOLUTION)
