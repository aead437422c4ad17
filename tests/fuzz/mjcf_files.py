"""Hostile models of MuJoCo: a good one with random changes of attributes and elements, one a seed."""

from __future__ import annotations

from copy import deepcopy
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from urdfs import VALUES

GOOD = """<mujoco model="m"><compiler angle="radian"/><option gravity="0 0 -9.81"/>
<default><joint damping="0.5" armature="0.02"/><geom density="900"/>
<default class="leg"><joint stiffness="1" springref="0.1"/><geom size="0.03 0.1"/></default></default>
<asset><mesh name="m" vertex="0 0 0 0.1 0 0 0 0.1 0 0 0 0.1" scale="1 1 1"/>
<material name="red" rgba="1 0 0 1"/></asset>
<worldbody><body name="upper" pos="0 0 0.2" quat="1 0 0 0">
<joint name="shoulder" type="hinge" axis="0 1 0" range="-2 2" pos="0 0 0"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.4" mass="1" material="red"/>
<body name="fore" pos="0 0 0.4" euler="0 0 0" childclass="leg">
<inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.002"/>
<joint name="elbow" axis="0 1 0" range="-2 2" frictionloss="0.1"/><geom type="mesh" mesh="m" pos="0 0 0.1"/>
<body name="ram" axisangle="0 0 1 0.1"><joint name="slide" type="slide" axis="0 0 1" range="0 0.1"/>
<geom type="box" size="0.02 0.03 0.04" mass="0.2"/><geom type="ellipsoid" size="0.02 0.03 0.04"/>
<geom type="cylinder"/></body></body></body></worldbody>
<actuator><motor joint="shoulder" ctrlrange="-30 20" gear="2"/><position joint="slide" kp="9" forcerange="-15 15"/>
</actuator><equality><joint joint1="elbow" joint2="shoulder" active="false"/></equality></mujoco>"""

OTHERS = (
    "0 1",
    "2 1",
    "1 0 0 0 0 0 0",
    "mesh",
    "box",
    "ball",
    "free",
    "leg",
    "shoulder",
    "1e-12 1e-12 1e-12",
    "degree",
)
"""What is put in the place of an attribute, beside the values of URDFs."""

ELEMENTS = (
    "<freejoint/>",
    "<joint type='ball'/>",
    "<geom type='hfield' hfield='h'/>",
    "<geom mesh='m'/>",
    "<geom/>",
    "<inertial/>",
    "<body/>",
    "<joint/>",
    "<composite type='cable' count='9 1 1'/>",
    "<mesh vertex='0 0'/>",
    "<mesh file='/dev/zero'/>",
    "<frame pos='0 0 1'><geom size='0.1'/></frame>",
)


def hostile_mjcf(seed: int) -> bytes:
    """Return a model with random changes."""
    rng = np.random.default_rng([2026, seed])
    root = ElementTree.fromstring(GOOD)
    for _ in range(rng.integers(1, 4)):
        _change(root, rng)
    return ElementTree.tostring(root)


def _change(root: Element, rng: np.random.Generator) -> None:
    every = list(root.iter())
    element, other = every[rng.integers(len(every))], every[rng.integers(len(every))]
    change, keys = rng.integers(8), sorted(element.attrib)
    if change < 4 and keys:
        values = (*VALUES, *OTHERS)
        element.set(keys[rng.integers(len(keys))], values[rng.integers(len(values))])
    elif change == 4 and keys:
        del element.attrib[keys[rng.integers(len(keys))]]
    elif change == 5:
        element.append(ElementTree.fromstring(ELEMENTS[rng.integers(len(ELEMENTS))]))
    elif change == 6:
        element.append(deepcopy(other))
    else:
        element.attrib.update(other.attrib)
