"""Contacts that cannot hold are refused, and the error names the cause."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import robotraj as rt
from robotraj.dynamics.contacts.cones import Linearised
from robotraj.dynamics.contacts.edges.arc_foot import ArcFoot
from robotraj.dynamics.contacts.edges.line_contact import LineContact
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.loop_closure import LoopClosure
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.contacts.soles import PressureAndTorsion

NAN = float("nan")
SOLE = "left_sole_link"

ALONE: dict[str, tuple[Callable[[], Any], str]] = {
    "friction zero": (lambda: PointContact("foot", friction=0.0), "friction of PointContact 'foot' is 0"),
    "friction negative": (lambda: FlatFoot("foot", 0.1, friction=-1), "friction of FlatFoot 'foot' is -1"),
    "friction NaN": (lambda: LineContact("foot", friction=NAN), "friction of LineContact 'foot' is nan"),
    "friction infinite": (
        lambda: PointContact("foot", friction=float("inf")),
        "friction of PointContact 'foot' is inf",
    ),
    "friction words": (lambda: PointContact("foot", friction="high"), "friction of PointContact 'foot' is 'high'"),
    "name empty": (lambda: PointContact("foot", name=""), "name of PointContact"),
    "no cone": (lambda: PointContact("foot", cone=4), "cone of PointContact 'foot' is 4.*rt.contacts.SecondOrder"),
    "no cone of an edge": (lambda: LineContact("foot", cone=None), "cone of LineContact 'foot'"),
    "two faces": (lambda: Linearised(2), "Linearised has 2 faces"),
    "no ground": (lambda: PointContact("foot", ground=3.0), "ground must be"),
    "pulling ground": (lambda: PointContact("foot", normal_force=(-5, 10)), "normal_force of PointContact 'foot'"),
    "crossed forces": (lambda: FlatFoot("foot", 0.1, normal_force=(10, 5)), "normal_force of FlatFoot 'foot'"),
    "forces NaN": (lambda: PointContact("foot", normal_force=(0, NAN)), "normal_force"),
    "force alone": (lambda: PointContact("foot", normal_force=10.0), "normal_force"),
    "offset NaN": (lambda: PointContact("foot", offset=(0, 0, NAN)), "offset of PointContact 'foot'"),
    "offset of two": (lambda: PointContact("foot", offset=(0, 0)), "offset of PointContact 'foot'"),
    "sole without length": (lambda: FlatFoot("foot", 0.0), "length of FlatFoot 'foot' is 0"),
    "sole without size": (lambda: FlatFoot("foot", (0.0, 0.0)), "length of FlatFoot 'foot' is 0"),
    "sole behind itself": (lambda: FlatFoot("foot", (-0.2, 0.1)), "length of FlatFoot 'foot' is -0.2"),
    "sole of three lengths": (lambda: FlatFoot("foot", (0.1, 0.1, 0.1)), "length of FlatFoot"),
    "sole without width": (lambda: FlatFoot("foot", 0.1, 0.0), "width of FlatFoot 'foot' is 0"),
    "no sole": (lambda: FlatFoot("foot", 0.1, sole=4), "sole of FlatFoot 'foot' is 4.*rt.contacts.FourCorners"),
    "torsion negative": (lambda: PressureAndTorsion(radius=-0.1), "radius of a sole's torsion"),
    "no cone of a sole": (lambda: PressureAndTorsion(cone=4), "cone of a sole"),
    "normal of zeros": (lambda: FlatFoot("foot", 0.1, normal=(0, 0, 0)), "normal of FlatFoot 'foot' has length zero"),
    "forward along normal": (
        lambda: FlatFoot("foot", 0.1, normal=(0, 0, 1), forward=(0, 0, 2)),
        "forward axis of FlatFoot 'foot' is along its normal",
    ),
    "arc without radius": (lambda: ArcFoot("foot", 0.0, 0.2), "radius of ArcFoot 'foot' is 0"),
    "arc without length": (lambda: ArcFoot("foot", 0.1, -0.2), "length of ArcFoot 'foot' is -0.2"),
    "arc on stairs": (lambda: ArcFoot("foot", 0.1, 0.2, ground=lambda x, y: 0.1 * x * x), "rolls on a plane"),
    "edge without width": (lambda: LineContact("foot", 0.0), "width of LineContact 'foot' is 0"),
    "edge without direction": (
        lambda: LineContact("foot", 0.1, direction=(0, 0, 0)),
        "direction of LineContact 'foot'",
    ),
    "loop with a rotation of another length": (
        lambda: LoopClosure("hand", "other", rigid=True, rotation_b=(0.0, 0.0, 1.0, 1.0)),
        r"rotation_b of LoopClosure 'hand-other' is \(0.0, 0.0, 1.0, 1.0\); give a quaternion",
    ),
    "free loop with a rotation": (
        lambda: LoopClosure("hand", "other", rotation_b=(1.0, 0.0, 0.0, 0.0)),
        "its frames turn freely; give rigid=True",
    ),
    "loop of one frame": (lambda: LoopClosure("foot", "foot"), "joins frame 'foot' to itself"),
}


@pytest.mark.parametrize("what", ALONE)
def test_values_that_cannot_hold_are_refused_when_made(what: str) -> None:
    make, message = ALONE[what]
    with pytest.raises(rt.InputError, match=message):
        make()


BOUND: dict[str, tuple[Any, tuple[str, str], str]] = {
    "unknown frame": (PointContact("FL_FOT"), ("solo12", "floating"), "no frame named 'FL_FOT'.*FL_FOOT"),
    "frame that is no text": (PointContact(3), ("solo12", "floating"), "no frame named 3"),
    "unknown foot": (FlatFoot("left_sole", 0.2, 0.1), ("talos_legs", "floating"), "left_sole_link"),
    "unknown edge": (LineContact("left_sole", 0.1), ("talos_legs", "floating"), "left_sole_link"),
    "unknown loop": (LoopClosure(SOLE, "right_sole"), ("talos_legs", "floating"), "right_sole_link"),
    "point out of the plane": (
        PointContact("FL_FOOT"),
        ("solo12", "planar"),
        "'FL_FOOT'.*leaves the x-z plane.*locked=",
    ),
    "foot out of the plane": (FlatFoot(SOLE, 0.2), ("talos_legs", "planar"), "leaves the x-z plane"),
    "edge out of the plane": (LineContact(SOLE), ("talos_legs", "planar"), "leaves the x-z plane"),
    "foot without width in space": (FlatFoot(SOLE, 0.2), ("talos_legs", "floating"), "has no width"),
    "edge without width in space": (LineContact(SOLE), ("talos_legs", "floating"), "has no width"),
    "normal out of the plane": (
        FlatFoot("left_foot", 0.2, normal=(0, 0, 1), forward=(0, 1, 0)),
        ("five_link", "planar"),
        "do not lie in the plane",
    ),
    "foot on a leg of three joints": (FlatFoot("FL_FOOT", 0.1, 0.1), ("solo12", "fixed"), "holds 6 rows.*3 of them"),
    "arc without width in space": (ArcFoot(SOLE, 0.1, 0.2), ("talos_legs", "floating"), "ArcFoot .* has no width"),
    "arc that cannot turn": (ArcFoot("block", 0.1, 0.2), ("block", "fixed"), "moves along the ground and turns"),
    "edge on a leg of three joints": (LineContact("FL_FOOT", 0.1), ("solo12", "fixed"), "holds 5 rows.*3 of them"),
    "point on one joint": (PointContact("left_foot"), ("compass_walker", "fixed"), "holds 2 rows.*1 of them"),
    "frame that stands still": (PointContact("universe"), ("solo12", "floating"), "cannot move up or down"),
    "loop on one body": (LoopClosure("left_tibia", "left_foot"), ("five_link", "planar"), "fixed to one body"),
}


@pytest.mark.parametrize("what", BOUND)
def test_contacts_that_do_not_fit_the_robot_are_refused_when_bound(what: str) -> None:
    contact, (robot, root), message = BOUND[what]
    with pytest.raises(rt.InputError, match=message):
        contact.bind(rt.load(robot, root=root))


def test_an_axis_in_which_the_robot_cannot_move_has_no_row(robot_of: Any) -> None:
    """A planar arm that presses on a table, and a foot on one rail."""
    arm = PointContact("tip").bind(robot_of("acrobot", "fixed"))
    assert [force.name for force in arm.forces] == ["force.tip.x", "force.tip.z"]
    rail = rt.load("hopper", locked={"hip": 0.0})
    foot = PointContact("foot").bind(rail)
    assert [force.name for force in foot.forces] == ["force.foot.z"] and foot.anchors == ()
    assert [row.name for row in foot.limit_rows] == ["normal force"]
