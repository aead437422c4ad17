"""Groups of feet that swing together: the tripods of six legs, and other groups by name."""

from __future__ import annotations

import pytest

import robotraj as rt
from robotraj.gait.mirroring.foot_groups import foot_groups, halves
from robotraj.robot.sides.images import frames_across
from tests.robots.many_legs import SIX, legged

FEET = [f"{leg}_foot" for leg in SIX]
TRIPODS = ({"FR_foot", "HR_foot", "ML_foot"}, {"FL_foot", "HL_foot", "MR_foot"})


@pytest.fixture(scope="module")
def hexapod(tmp_path_factory):
    return legged(tmp_path_factory.mktemp("hexapod"), SIX)


def test_six_feet_alternate_in_two_tripods_of_which_the_one_of_the_first_foot_stands_first(hexapod):
    assert tuple(set(group) for group in foot_groups(hexapod, FEET, None)) == TRIPODS
    other = tuple(reversed(TRIPODS))
    assert tuple(set(group) for group in foot_groups(hexapod, [FEET[1], FEET[0], *FEET[2:]], None)) == other
    assert halves(foot_groups(hexapod, FEET, None), frames_across(hexapod, FEET))


def test_the_feet_of_a_biped_alternate_and_four_feet_have_no_groups_by_default(hexapod):
    assert foot_groups(hexapod, ["FL_foot", "FR_foot"], None) == (("FR_foot",), ("FL_foot",))
    assert foot_groups(hexapod, FEET[:4], None) == ()


def test_pairs_across_are_no_mirrored_halves(hexapod):
    pairs = (("ML_foot", "MR_foot"), ("FL_foot", "FR_foot"), ("HL_foot", "HR_foot"))
    assert not halves(foot_groups(hexapod, FEET, pairs), frames_across(hexapod, FEET))


@pytest.mark.parametrize("groups", [[FEET], [FEET[:3], FEET[2:]], [FEET[:3], ["FL_foot"]], [FEET, []]])
def test_groups_hold_each_foot_once(hexapod, groups):
    with pytest.raises(rt.InputError, match="name each of the feet FL_foot, FR_foot"):
        foot_groups(hexapod, FEET, groups)
