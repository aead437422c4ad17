"""An independent reader of URDF: mass, poses, mass matrix and gravity from the XML, with NumPy alone.

It shares nothing with Pinocchio or robotraj: no recursion, only sums over links of Jacobians of their centres of mass,
M = sum m Jv' Jv + Jw' I Jw  and  g = sum m Jv' (0, 0, 9.81). Joints that follow others add their columns to the
leader's, times the multiplier.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from robotraj._util.arrays import Array

TURNING = ("revolute", "continuous")
MOVING = (*TURNING, "prismatic")


@dataclass(frozen=True)
class Joint:
    """One joint: its place in the parent link, its axis, and what it follows."""

    name: str
    kind: str
    parent: str
    child: str
    place: Array
    axis: Array
    mimic: tuple[str, float, float] | None


@dataclass(frozen=True)
class Link:
    """Mass [kg], centre of mass [m] and inertia about it [kg m^2], in the axes of the link."""

    mass: float
    centre: Array
    inertia: Array


class Tree:
    """The links and joints of a URDF."""

    def __init__(self, path: Path) -> None:
        root = ElementTree.fromstring(path.read_bytes())
        self.links = {each.get("name", ""): _link(each) for each in root.findall("link")}
        self.joints = {joint.name: joint for joint in map(_joint, root.findall("joint"))}
        self.above = {joint.child: joint for joint in self.joints.values()}

    def position(self, joint: Joint, q: Mapping[str, float]) -> float:
        """Return the position of a joint [rad, m]; joints that are not in q rest at 0."""
        if joint.mimic is not None:
            leader, times, offset = joint.mimic
            return times * self.position(self.joints[leader], q) + offset
        return q.get(joint.name, 0.0)

    def drive(self, joint: Joint) -> tuple[str, float]:
        """Return the joint that moves this one, and the rate of this one relative to it."""
        if joint.mimic is None:
            return joint.name, 1.0
        name, rate = self.drive(self.joints[joint.mimic[0]])
        return name, joint.mimic[1] * rate

    def pose(self, link: str, q: Mapping[str, float]) -> Array:
        """Return the pose (4, 4) of a link in the root link."""
        if link not in self.above:
            return np.eye(4)
        joint = self.above[link]
        return self.pose(joint.parent, q) @ joint.place @ _motion(joint, self.position(joint, q))

    def dynamics(self, q: Mapping[str, float], names: tuple[str, ...]) -> tuple[float, Array, Array]:
        """Return the mass of all links, and the mass matrix and gravity's torques for these joints."""
        count, total = len(names), 0.0
        mass, gravity = np.zeros((count, count)), np.zeros(count)
        poses = {name: self.pose(name, q) for name in self.links}
        for name, link in self.links.items():
            total += link.mass
            pose = poses[name]
            centre = pose[:3, 3] + pose[:3, :3] @ link.centre
            linear, angular = np.zeros((3, count)), np.zeros((3, count))
            at = name
            while at in self.above:
                joint = self.above[at]
                moved_by, rate = self.drive(joint)
                if joint.kind in MOVING and moved_by in names:
                    column = names.index(moved_by)
                    axis = rate * (poses[at][:3, :3] @ joint.axis)
                    if joint.kind == "prismatic":
                        linear[:, column] += axis
                    else:
                        angular[:, column] += axis
                        linear[:, column] += np.cross(axis, centre - poses[at][:3, 3])
                at = joint.parent
            turned = pose[:3, :3] @ link.inertia @ pose[:3, :3].T
            mass += link.mass * linear.T @ linear + angular.T @ turned @ angular
            gravity += link.mass * 9.81 * linear[2]
        return total, mass, gravity


def _numbers(element: ElementTree.Element | None, name: str, default: str) -> Array:
    text = default if element is None else element.get(name, default)
    return np.array([float(each) for each in text.split()])


def _turned(rpy: Array) -> Array:
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def _place(element: ElementTree.Element | None) -> Array:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = _turned(_numbers(element, "rpy", "0 0 0")), _numbers(element, "xyz", "0 0 0")
    return pose


def _link(element: ElementTree.Element) -> Link:
    inertial = element.find("inertial")
    if inertial is None:
        return Link(0.0, np.zeros(3), np.zeros((3, 3)))
    place, given = _place(inertial.find("origin")), inertial.find("inertia")
    x = {} if given is None else {key: float(value) for key, value in given.attrib.items()}
    own = np.array([[x.get(f"i{min(a, b)}{max(a, b)}", 0.0) for b in "xyz"] for a in "xyz"])
    mass = inertial.find("mass")
    return Link(
        0.0 if mass is None else float(mass.get("value", 0.0)), place[:3, 3], place[:3, :3] @ own @ place[:3, :3].T
    )


def _joint(element: ElementTree.Element) -> Joint:
    axis = _numbers(element.find("axis"), "xyz", "1 0 0")
    follows = element.find("mimic")
    mimic = None
    if follows is not None:
        mimic = (
            follows.get("joint", ""),
            float(follows.get("multiplier", 1.0)),
            float(follows.get("offset", 0.0)),
        )
    parent, child = element.find("parent"), element.find("child")
    assert parent is not None and child is not None
    return Joint(
        element.get("name", ""),
        element.get("type", "fixed"),
        parent.get("link", ""),
        child.get("link", ""),
        _place(element.find("origin")),
        axis / (np.linalg.norm(axis) or 1.0),
        mimic,
    )


def _motion(joint: Joint, position: float) -> Array:
    pose = np.eye(4)
    if joint.kind == "prismatic":
        pose[:3, 3] = position * joint.axis
    elif joint.kind in TURNING:
        x, y, z = joint.axis
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pose[:3, :3] += np.sin(position) * cross + (1.0 - np.cos(position)) * cross @ cross
    return pose
