"""Random trees of all kinds of joints, each written twice: as a URDF, and for MuJoCo without its followers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from xml.etree.ElementTree import Element, SubElement, tostring

import numpy as np
import pinocchio as pin

KINDS = ("revolute", "continuous", "prismatic", "planar", "spherical", "follower", "follower")
X, Y, Z = np.eye(3)
PARTS = {
    "planar": (("_x", "slide", X), ("_y", "slide", Y), ("_yaw", "hinge", Z)),
    "spherical": (("_yaw", "hinge", Z), ("_pitch", "hinge", Y), ("_roll", "hinge", X)),
}
"""Joints of MuJoCo that are a planar joint or a ball."""


@dataclass(frozen=True)
class Joint:
    """One joint with the body that it moves."""

    name: str
    kind: str
    parent: str
    place: pin.SE3
    axis: np.ndarray
    body: pin.Inertia
    damping: float = 0.0
    follows: tuple[str, float, float] | None = None
    spring: tuple[float, float] = (0.0, 0.0)
    rotor: tuple[float, float] = (0.0, 0.0)

    @property
    def child(self) -> str:
        """Name of its link."""
        return self.name.replace("j", "l")

    @property
    def parts(self):
        """Names, types and axes of its joints in MuJoCo."""
        own = "slide" if self.kind == "prismatic" else "hinge"
        return [(self.name + end, kind, axis) for end, kind, axis in PARTS.get(self.kind, (("", own, self.axis),))]


@dataclass(frozen=True)
class DrawnTree:
    """A tree, which is drawn anew for every seed."""

    joints: tuple[Joint, ...]
    springs: dict = field(default_factory=dict)
    rotors: dict = field(default_factory=dict)

    @classmethod
    def of(cls, seed: int, count: int = 5) -> DrawnTree:
        """Draw joints on the last two links."""
        rng, joints = np.random.default_rng(seed), []
        for k in range(1, count + 1):
            kind = KINDS[int(rng.integers(len(KINDS)))] if k > 1 else "revolute"
            single = [j for j in joints if j.kind in ("revolute", "prismatic") and j.follows is None]
            axes, axis = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3)
            inertia = axes @ np.diag([0.02, 0.025, 0.03]) @ axes.T
            body = pin.Inertia(rng.uniform(0.3, 3.0), rng.uniform(-0.1, 0.1, 3), inertia)
            place = pin.SE3(pin.rpy.rpyToMatrix(*rng.uniform(-1, 1, 3)), rng.uniform(-0.3, 0.3, 3))
            parent, axis = f"l{int(rng.integers(max(0, k - 2), k))}", axis / np.linalg.norm(axis)
            joint = Joint(f"j{k}", kind, parent, place, Z if kind == "planar" else axis, body)
            if kind == "follower":
                leader, times = single[int(rng.integers(len(single)))], rng.choice([-1, 1]) * rng.uniform(0.4, 1.0)
                kind = ("revolute", "prismatic")[int(rng.integers(2))]
                joint = replace(joint, kind=kind, follows=(leader.name, times, rng.uniform(-0.2, 0.2)))
            elif kind not in PARTS:
                spring = (rng.uniform(1, 20), rng.uniform(-0.5, 0.5)) if kind != "continuous" else (0.0, 0.0)
                rotor = rng.uniform(1e-5, 1e-4), rng.uniform(20, 80)
                joint = replace(joint, damping=rng.uniform(0.0, 0.3), spring=spring, rotor=rotor)
            joints.append(joint)
        return cls(
            tuple(joints),
            {joint.name: joint.spring for joint in joints if joint.spring[0]},
            {joint.name: joint.rotor for joint in joints if joint.rotor[0]},
        )

    @property
    def urdf(self) -> str:
        """The tree as a URDF, without springs and rotors."""
        root = Element("robot", name="tree")
        SubElement(root, "link", name="l0")
        for joint in self.joints:
            link, body = SubElement(root, "link", name=joint.child), joint.body
            inertial = SubElement(link, "inertial")
            SubElement(inertial, "origin", xyz=text(body.lever))
            SubElement(inertial, "mass", value=text(body.mass))
            numbers = {f"i{'xyz'[a]}{'xyz'[b]}": text(body.inertia[a, b]) for a in range(3) for b in range(a, 3)}
            SubElement(inertial, "inertia", numbers)
            made = SubElement(root, "joint", name=joint.name, type=joint.kind)
            SubElement(made, "parent", link=joint.parent)
            SubElement(made, "child", link=joint.child)
            turned = text(pin.rpy.matrixToRpy(joint.place.rotation))
            SubElement(made, "origin", xyz=text(joint.place.translation), rpy=turned)
            SubElement(made, "axis", xyz=text(joint.axis))
            SubElement(made, "limit", lower="-2", upper="2", velocity="4", effort="80")
            SubElement(made, "dynamics", damping=text(joint.damping))
            if joint.follows is not None:
                leader, times, offset = joint.follows
                SubElement(made, "mimic", joint=leader, multiplier=text(times), offset=text(offset))
        return tostring(root, encoding="unicode")

    @property
    def mjcf(self) -> str:
        """The tree for MuJoCo; its followers are joints of their own."""
        root = Element("mujoco")
        SubElement(root, "compiler", angle="radian", autolimits="false")
        SubElement(root, "option", gravity="0 0 -9.81")
        bodies = {"l0": SubElement(root, "worldbody")}
        for joint in self.joints:
            x, y, z, w = pin.Quaternion(joint.place.rotation).coeffs()
            place = {"pos": text(joint.place.translation), "quat": text([w, x, y, z])}
            bodies[joint.child] = own = SubElement(bodies[joint.parent], "body", place, name=joint.child)
            (stiffness, rest), (inertia, ratio) = joint.spring, joint.rotor
            for name, kind, axis in joint.parts:
                passive = {"damping": text(joint.damping), "stiffness": text(stiffness), "springref": text(rest)}
                armature = text(inertia * ratio**2)
                SubElement(own, "joint", passive, name=name, type=kind, axis=text(axis), armature=armature)
            i = joint.body.inertia
            full = text([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])
            SubElement(own, "inertial", pos=text(joint.body.lever), mass=text(joint.body.mass), fullinertia=full)
        return tostring(root, encoding="unicode")

    def coupling(self, every: list[str], names: list[str]) -> tuple[np.ndarray, np.ndarray]:
        """Return S and s with q_all = S q + s, for the joints of MuJoCo and those of the robot."""
        follows = {joint.name: joint.follows for joint in self.joints if joint.follows is not None}
        rates, offsets = np.zeros((len(every), len(names))), np.zeros(len(every))
        for i, name in enumerate(every):
            leader, times, offsets[i] = follows.get(name, (name, 1.0, 0.0))
            rates[i, names.index(leader)] = times
        return rates, offsets


def text(values) -> str:
    """Return numbers with all their digits."""
    return " ".join(repr(float(value)) for value in np.atleast_1d(values))
