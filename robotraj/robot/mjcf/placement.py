"""Poses of elements of an MJCF file, by any of the attributes that MuJoCo knows.

Source: the section *Frame orientations* of MuJoCo's documentation of its models. Quaternions are (w, x, y, z) there.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.mjcf.defaults import Attributes

PLACED = ("body", "geom", "site", "inertial")
AXES = dict(zip("xyz", np.eye(3), strict=True))


class Placement:
    """Poses by the conventions of a file: its unit of angles and its order of Euler angles."""

    def __init__(self, root: Element) -> None:
        stated = {name: text for compiler in root.findall("compiler") for name, text in compiler.attrib.items()}
        self._unit = 1.0 if stated.get("angle") == "radian" else np.pi / 180.0
        self._sequence = stated.get("eulerseq", "xyz")

    def of(self, own: Attributes) -> pin.SE3:
        """Return the pose of an element in its body; z goes from the first end to the second where ends are given."""
        place = np.array(own.get("pos", "0 0 0").split(), dtype=float)[:3]
        if "fromto" in own:
            first, second = np.array(own["fromto"].split(), dtype=float)[:6].reshape(2, 3)
            return pin.SE3(_z_along(second - first), 0.5 * (first + second))
        return pin.SE3(self._rotation(own), place)

    def _rotation(self, own: Attributes) -> Array:
        given = {key: np.array(own[key].split(), dtype=float) for key in own if key in _KINDS}
        if "quat" in given:
            return _of_quaternion(given["quat"])
        if "axisangle" in given:
            axis = given["axisangle"][:3]
            return np.array(pin.exp3(self._unit * given["axisangle"][3] * axis / (np.linalg.norm(axis) or 1.0)))
        if "euler" in given:
            return self._euler(given["euler"])
        if "xyaxes" in given:
            x = _unit(given["xyaxes"][:3])
            y = _unit(given["xyaxes"][3:6] - x * (x @ given["xyaxes"][3:6]))
            return np.column_stack([x, y, np.cross(x, y)])
        return _z_along(given["zaxis"]) if "zaxis" in given else np.eye(3)

    def _euler(self, angles: Array) -> Array:
        """Small letters turn about axes that move along, capital ones about fixed axes."""
        whole = np.eye(3)
        for letter, angle in zip(self._sequence, angles, strict=False):
            turn = np.array(pin.exp3(self._unit * angle * AXES[letter.lower()]))
            whole = whole @ turn if letter.islower() else turn @ whole
        return whole


def with_plain_poses(root: Element) -> None:
    """Give every element its orientation as a quaternion of length 1.

    Pinocchio's reader takes quaternions and axes as they are, so that rotations of others also stretch.
    """
    place = Placement(root)
    for element in root.iter():
        if element.tag in PLACED and "fromto" not in element.attrib and not _KINDS.isdisjoint(element.attrib):
            x, y, z, w = pin.Quaternion(place.of(element.attrib).rotation).coeffs()
            for kind in _KINDS:
                element.attrib.pop(kind, None)
            element.set("quat", " ".join(repr(float(number)) for number in (w, x, y, z)))


_KINDS = frozenset({"quat", "axisangle", "euler", "xyaxes", "zaxis"})


def _of_quaternion(wxyz: Array) -> Array:
    w, x, y, z = wxyz[:4] / (np.linalg.norm(wxyz[:4]) or 1.0)
    return np.array(pin.Quaternion(w, x, y, z).toRotationMatrix())


def _unit(vector: Array) -> Array:
    return np.asarray(vector / (np.linalg.norm(vector) or 1.0))


def _z_along(way: Array) -> Array:
    """Return the least rotation of z into a direction."""
    return np.array(pin.Quaternion.FromTwoVectors(AXES["z"], _unit(way)).toRotationMatrix())
