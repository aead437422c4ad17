"""Hostile URDFs: random trees of links with shapes and limits, changed at random places, one a seed."""

from __future__ import annotations

from copy import deepcopy
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

VALUES = (
    "",
    " ",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1e400",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-0",
    "-1",
    "1",
    "1,5",
    "0x10",
    "1_000",
    "1e",
    "one",
    "0 0 0",
    "0 0",
    "0 0 0 0",
    "nan nan nan",
    "1e200 1e200 1e200",
    "9" * 400,
    "x" * 100_000,
    "\u0661\u0662",
    "universe",
    "root_joint",
    "__proto__",
    "a\nb",
    "${evil}",
    "$(find evil)/x",
    "../../../../etc/passwd",
    "/dev/zero",
    "/etc/hostname",
    "package://../../../etc/passwd",
    "package://",
    "file:///proc/self/environ",
    "http://127.0.0.1:9/a.stl",
    "model://a.dae",
    "%s%n%s%n",
    "fixed",
    "floating",
    "planar",
    "spherical",
    "revolute",
    "continuous",
    "true",
)
"""What is put in the place of an attribute."""

TAGS = ("link", "joint", "inertial", "origin", "axis", "limit", "mimic", "dynamics", "visual", "mass", "inertia", "x")

DOCTYPES = (
    '<!DOCTYPE r [<!ENTITY a "0"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">'
    '<!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;"><!ENTITY e "&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;">'
    '<!ENTITY f "&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;"><!ENTITY g "&f;&f;&f;&f;&f;&f;&f;&f;&f;&f;">]>',
    '<!DOCTYPE r [<!ENTITY g SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE r SYSTEM "http://127.0.0.1:9/evil.dtd">',
)


def good_urdf(rng: np.random.Generator) -> Element:
    """Return a random tree of links that can be planned with."""
    count = int(rng.integers(2, 8))
    root = Element("robot", name="fuzz")
    for i in range(count):
        link = SubElement(root, "link", name=f"l{i}")
        inertial = SubElement(link, "inertial")
        SubElement(inertial, "origin", xyz=_triple(rng), rpy=_triple(rng))
        SubElement(inertial, "mass", value=f"{rng.uniform(0.1, 5):.4f}")
        a, b, c = rng.uniform(0.01, 0.1, 3)
        SubElement(
            inertial, "inertia", ixx=f"{a + b:.5f}", iyy=f"{b + c:.5f}", izz=f"{a + c:.5f}", ixy="0", ixz="0", iyz="0"
        )
        for kind in ("visual", "collision"):
            shape = SubElement(link, kind)
            SubElement(shape, "origin", xyz=_triple(rng), rpy=_triple(rng))
            geometry = SubElement(shape, "geometry")
            which = rng.integers(4)
            if which == 0:
                SubElement(geometry, "box", size="0.1 0.2 0.3")
            elif which == 1:
                SubElement(geometry, "cylinder", radius="0.1", length="0.3")
            elif which == 2:
                SubElement(geometry, "sphere", radius="0.1")
            else:
                SubElement(geometry, "mesh", filename="package://fuzz/a.stl", scale="1 1 1")
    for i in range(1, count):
        kind = str(rng.choice(["revolute", "revolute", "continuous", "prismatic", "fixed", "floating", "planar"]))
        joint = SubElement(root, "joint", name=f"j{i}", type=kind if i > 1 else "revolute")
        SubElement(joint, "parent", link=f"l{rng.integers(i)}")
        SubElement(joint, "child", link=f"l{i}")
        SubElement(joint, "origin", xyz=_triple(rng), rpy=_triple(rng))
        SubElement(joint, "axis", xyz=str(rng.choice(["1 0 0", "0 1 0", "0 0 1", "0.6 0.8 0"])))
        SubElement(joint, "limit", lower="-1", upper="1", velocity="2", effort="50")
        if rng.random() < 0.3:
            SubElement(joint, "dynamics", damping="0.1", friction="0.1")
        if rng.random() < 0.2 and i > 1:
            SubElement(joint, "mimic", joint="j1", multiplier="2", offset="0.1")
    return root


def unchanged_urdf(seed: int) -> bytes:
    """Return a random tree whose moving joints have one degree of freedom; every one loads."""
    root = good_urdf(np.random.default_rng(seed))
    for joint in root.findall("joint"):
        if joint.get("type") in ("floating", "planar"):
            joint.set("type", "fixed")
    return ElementTree.tostring(root)


def hostile_urdf(seed: int) -> bytes:
    """Return a URDF with random changes."""
    rng = np.random.default_rng([2022, seed])
    root = good_urdf(rng)
    kind = rng.choice(["tree", "tree", "tree", "tree", "tree", "bytes", "bytes", "doctype", "deep", "encoding"])
    if kind == "tree":
        for _ in range(rng.integers(1, 5)):
            _change_tree(root, rng)
        return ElementTree.tostring(root)
    data = bytearray(ElementTree.tostring(root))
    if kind == "bytes":
        for _ in range(rng.integers(1, 6)):
            place = int(rng.integers(len(data)))
            change = rng.integers(4)
            if change == 0:
                data[place] = rng.integers(256)
            elif change == 1:
                del data[place : place + int(rng.integers(1, 50))]
            elif change == 2:
                data[place:place] = data[place : place + int(rng.integers(1, 300))]
            else:
                data[place:place] = bytes([*b"<>&\"'/\0"][rng.integers(7)] for _ in range(3))
        return bytes(data)
    if kind == "doctype":
        text = bytes(data).decode().replace('value="', 'value="&g;', 1)
        return (DOCTYPES[rng.integers(len(DOCTYPES))] + text).encode()
    if kind == "deep":
        depth = int(10 ** rng.uniform(1, 5))
        tag = str(rng.choice(TAGS))
        return b"<robot name='r'>" + f"<{tag}>".encode() * depth + f"</{tag}>".encode() * depth + b"</robot>"
    codec = str(rng.choice(["utf-16", "latin-1", "utf-32", "cp037", "utf-7"]))
    claim = str(rng.choice([codec, "utf-8", "nonsense", "punycode", "rot13"]))
    return f'<?xml version="1.0" encoding="{claim}"?>{bytes(data).decode()}'.encode(codec)


def _change_tree(root: Element, rng: np.random.Generator) -> None:
    every = list(root.iter())
    element = every[rng.integers(len(every))]
    change = rng.integers(9)
    if change < 4 and element.attrib:
        keys = sorted(element.attrib)
        element.set(keys[rng.integers(len(keys))], VALUES[rng.integers(len(VALUES))])
    elif change == 4 and element.attrib:
        keys = sorted(element.attrib)
        del element.attrib[keys[rng.integers(len(keys))]]
    elif change == 5 and len(element):
        element.remove(element[rng.integers(len(element))])
    elif change == 6:
        element.append(deepcopy(every[rng.integers(len(every))]))
    elif change == 7:
        element.tag = TAGS[rng.integers(len(TAGS))]
    else:
        other = every[rng.integers(len(every))]
        element.attrib.update(other.attrib)


def _triple(rng: np.random.Generator) -> str:
    return " ".join(f"{value:.3f}" for value in rng.uniform(-0.5, 0.5, 3))
