"""Contacts on robots of every root, at random points, on a ground that contains the foot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.edges.arc_foot import ArcFoot
from robotraj.dynamics.contacts.edges.line_contact import LineContact
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.loop_closure import LoopClosure
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.contacts.soles import FourCorners
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Named
from robotraj.witness.point import NumericPoint

Array = np.ndarray
SOLE = "left_sole_link"
load = cache(lambda name, root: rt.load(name, root=root))


@dataclass(frozen=True)
class Case:
    """A contact on a robot, and how many rows it holds."""

    robot: rt.Robot
    contact: Any
    rows: int
    wall: tuple[float, float, float] | None = None

    def bind(self) -> BoundContact:
        return self.contact.bind(self.robot)

    def random(self, seed: int) -> tuple[Array, Array, Array]:
        rng = np.random.default_rng(seed)
        nv = self.robot.nv
        q = pin.integrate(self.robot.model, np.array(self.robot.neutral), rng.uniform(-0.4, 0.4, nv))
        return q, rng.uniform(-1, 1, nv), rng.uniform(-1, 1, nv)

    def numbers(self, q: Array, v: Array, a: Array) -> NumericPoint:
        return NumericPoint(self.robot, 0.0, q, v, a, np.zeros(self.robot.nu))

    def symbols(self, q: ca.SX, v: ca.SX, a: ca.SX) -> RobotPoint:
        none = Named("none", (), ())
        return RobotPoint(0.0, none, none, none, none, self.robot, q, v, a, None)

    def placed(self, q: Array) -> Any:
        """Return the case with a ground under the foot in q: a plane through it, along the sole or the edge."""
        if isinstance(self.contact, LoopClosure):
            return self
        if self.wall is not None:
            return self.on_wall(q)
        frame = self.numbers(q, np.zeros(self.robot.nv), np.zeros(self.robot.nv)).frame(self.contact.frame)
        x, y, z = frame.position + frame.rotation @ np.array(self.contact.offset)
        bound = self.bind()
        up, axes = np.array([0.1, -0.2, 1.0]), {}
        if isinstance(self.contact, ArcFoot):
            return self.on_arc(frame)
        if isinstance(self.contact, FlatFoot):
            axes = {"normal": bound.feet.up, "forward": bound.feet.forward}  # type: ignore[attr-defined]
            up = frame.rotation @ np.array(axes["normal"])
        elif len(bound.anchors) == 3:
            axes = {"direction": bound.along}  # type: ignore[attr-defined]
            left = frame.rotation @ np.array(axes["direction"])
            up = up - (up @ left) * left
        slopes = -up[:2] / up[2]
        ground = rt.terrain.Slope(*slopes, z - slopes @ np.array([x, y]))
        return replace(self, contact=replace(self.contact, ground=ground, **axes))

    def on_arc(self, frame: Any) -> Case:
        """Return the case with a ground that the arc touches: along its axis, at the arc's radius from it."""
        bound: Any = self.bind()
        up, axes = np.array([0.1, -0.2, 1.0]), {"normal": bound.spot.up}
        if len(bound.anchors) == 3:
            left = np.array(bound.along)
            axes["forward"] = tuple(np.cross(left, bound.spot.up))
            left = frame.rotation @ left
            up = up - (up @ left) * left
        else:
            up[1] = 0.0
        up = up / np.linalg.norm(up)
        place = frame.position + frame.rotation @ np.array(bound.spot.offset) - self.contact.radius * up
        slopes = -up[:2] / up[2]
        ground = rt.terrain.Slope(*slopes, place[2] - slopes @ place[:2])
        return replace(self, contact=replace(self.contact, ground=ground, **axes))

    def on_wall(self, q: Array) -> Case:
        """Return the case with a wall through the point in q, along the sole if it has one."""
        frame = self.numbers(q, np.zeros(self.robot.nv), np.zeros(self.robot.nv)).frame(self.contact.frame)
        place = frame.position + frame.rotation @ np.array(self.contact.offset)
        outward = np.array(self.wall)
        if isinstance(self.contact, FlatFoot):
            outward = frame.rotation @ np.array(self.contact.normal)
        return replace(self, contact=replace(self.contact, ground=rt.terrain.Plane(place, outward)))


CASES: dict[str, Callable[[], Case]] = {
    "point, fixed root": lambda: Case(load("solo12", "fixed"), PointContact("FL_FOOT"), 3),
    "point beside its frame, floating root": lambda: Case(
        load("solo12", "floating"), PointContact("HR_FOOT", offset=(0.01, -0.02, 0.03)), 3
    ),
    "point, planar root": lambda: Case(load("five_link", "planar"), PointContact("left_foot"), 2),
    "point beside its frame, planar root": lambda: Case(
        load("five_link", "planar"), PointContact("left_foot", offset=(0.1, 0.0, -0.02)), 2
    ),
    "point on a wall, floating root": lambda: Case(
        load("solo12", "floating"), PointContact("FL_FOOT", offset=(0.01, -0.02, 0.03)), 3, (-1.0, 0.1, 0.2)
    ),
    "point under a ceiling, fixed root": lambda: Case(
        load("solo12", "fixed"), PointContact("FL_FOOT"), 3, (0.2, 0.1, -1.0)
    ),
    "point on a wall, planar root": lambda: Case(
        load("five_link", "planar"), PointContact("left_foot"), 2, (1.0, 0.0, 0.3)
    ),
    "palm on a wall, floating root": lambda: Case(
        load("talos_legs", "floating"), FlatFoot(SOLE, 0.2, 0.1, normal=(1, 0, 0), forward=(0, 0, 1)), 6, (1, 0, 0)
    ),
    "sole on a wall, planar root": lambda: Case(
        load("five_link", "planar"), FlatFoot("right_foot", 0.1, normal=(1, 0, 0), forward=(0, 0, -1)), 3, (1, 0, 0)
    ),
    "point on a rail": lambda: Case(load("hopper", "fixed"), PointContact("foot"), 2),
    "flat foot, floating root": lambda: Case(load("talos_legs", "floating"), FlatFoot(SOLE, 0.2, 0.1), 6),
    "flat foot, four corners, fixed root": lambda: Case(
        load("talos_legs", "fixed"), FlatFoot(SOLE, (0.08, 0.12), 0.1, sole=FourCorners()), 6
    ),
    "flat foot below its frame, floating root": lambda: Case(
        load("talos_legs", "floating"), FlatFoot("leg_left_6_joint", 0.2, 0.1, offset=(0.01, 0.0, -0.107)), 6
    ),
    "flat foot, planar root": lambda: Case(load("five_link", "planar"), FlatFoot("right_foot", (0.05, 0.1)), 3),
    "toe, floating root": lambda: Case(
        load("talos_legs", "floating"), LineContact(SOLE, 0.1, offset=(0.1, 0.0, 0.0)), 5
    ),
    "edge at its frame, fixed root": lambda: Case(load("talos_legs", "fixed"), LineContact(SOLE, 0.1), 5),
    "toe, planar root": lambda: Case(load("five_link", "planar"), LineContact("left_foot", offset=(0.1, 0, 0)), 2),
    "arc, planar root": lambda: Case(load("five_link", "planar"), ArcFoot("left_foot", 0.3, 0.4), 2),
    "arc that leans in its frame, planar root": lambda: Case(
        load("five_link", "planar"), ArcFoot("left_foot", 0.2, (0.1, 0.2), offset=(0.1, 0, 0), normal=(0.3, 0, 1)), 2
    ),
    "arc, floating root": lambda: Case(
        load("talos_legs", "floating"), ArcFoot(SOLE, 0.25, 0.3, 0.1, offset=(0.02, 0.01, 0.0)), 5
    ),
    "arc, fixed root": lambda: Case(load("talos_legs", "fixed"), ArcFoot(SOLE, 0.1, 0.2, 0.1), 5),
    "loop of two points": lambda: Case(load("talos_legs", "floating"), LoopClosure(SOLE, "right_sole_link"), 3),
    "loop of two placements": lambda: Case(
        load("talos_legs", "floating"), LoopClosure(SOLE, "right_sole_link", rigid=True), 6
    ),
    "loop in a plane": lambda: Case(load("five_link", "planar"), LoopClosure("left_foot", "right_foot"), 2),
    "loop of two points beside their frames": lambda: Case(
        load("talos_legs", "floating"),
        LoopClosure(SOLE, "right_sole_link", True, offset_a=(0.1, 0.0, 0.02), offset_b=(0.0, 0.1, 0.0)),
        6,
    ),
    "loop of two placements that are turned to each other": lambda: Case(
        load("talos_legs", "floating"),
        LoopClosure(SOLE, "right_sole_link", True, offset_b=(0.0, 0.1, 0.0), rotation_b=(0.5, -0.5, 0.1, 0.7)),
        6,
    ),
    "arm held by the world": lambda: Case(
        load("ur5", "fixed"), LoopClosure("tool0", "universe", offset_b=(0.4, 0.2, 0.4)), 3
    ),
    "rigid loop in a plane": lambda: Case(
        load("five_link", "planar"), LoopClosure("left_foot", "right_foot", rigid=True), 3
    ),
}


@pytest.fixture(params=CASES, ids=str)
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]()


@pytest.fixture
def robot_of() -> Callable[[str, str], rt.Robot]:
    return load
