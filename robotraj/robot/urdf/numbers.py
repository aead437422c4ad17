"""Checks of a URDF's numbers: origins, axes, limits, masses and inertias.

Numbers that cannot be read are refused, because the parser behind Pinocchio replaces them by 0. Implausible numbers are
findings: ``rt.load`` warns of them, and ``robotraj show`` lists them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from xml.etree.ElementTree import Element

import numpy as np

from robotraj._util.errors import InputError
from robotraj.robot.loading.inertia import principal_moments, triangle_fault
from robotraj.robot.urdf.balls import BALLS
from robotraj.robot.urdf.limits import limit_findings, local
from robotraj.robot.urdf.springs import SPRING, spring_faults
from robotraj.robot.urdf.structure import SHOWN

JOINT_TYPES = {"revolute", "continuous", "prismatic", "floating", "planar", "fixed", *BALLS}
MOVING = {"revolute", "continuous", "prismatic"}
"""Joint types with one axis."""
JOINT_NUMBERS: Mapping[str, Sequence[str]] = {
    "limit": ("lower", "upper", "velocity", "effort", "acceleration", "jerk"),
    "dynamics": ("damping", "friction", *SPRING),
    "mimic": ("multiplier", "offset"),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit"),
}
"""Attributes of a joint's elements that are numbers."""
INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
FULL = [0, 1, 2, 1, 3, 4, 2, 4, 5]
"""Places in ``INERTIA`` of the entries of the matrix, row by row."""
SPEEDS = (1e-6, 1e6)
"""Plausible range of velocity limits [rad/s, m/s]; 0 and missing limits are reported elsewhere."""
LARGEST = 1e6
"""Largest coordinate of an origin, and largest size of a shape [m]."""
UNLIMITED = 1e20
"""Magnitudes above represent no limit."""


def check_numbers(file: str, root: Element) -> tuple[str, ...]:
    """Raise InputError for values that are no numbers, and return findings, one sentence each.

    Parameters
    ----------
    file : str
        The file's name for messages.
    root : Element
        The ``<robot>`` element, whose structure has been checked.

    Raises
    ------
    InputError
        Numbers are missing, unparsable, NaN or infinite, a mass is negative, or a joint type is unknown. The message
        lists the links and joints.
    """
    faults = [fault for joint in root.findall("joint") for fault in _joint_faults(joint)]
    faults += spring_faults(root)
    faults += [fault for link in root.findall("link") for fault in _link_faults(link)]
    if faults:
        more = f" And {len(faults) - SHOWN} more." if len(faults) > SHOWN else ""
        raise InputError(f"{file}: {'; '.join(faults[:SHOWN])}.{more}")
    joints = (finding for joint in root.findall("joint") for finding in _joint_findings(joint))
    return (*joints, *limit_findings(root), *_link_findings(root.findall("link")))


def _joint_faults(joint: Element) -> Iterator[str]:
    name, kind = joint.get("name"), joint.get("type")
    if kind not in JOINT_TYPES:
        yield f"joint {name!r} has type {kind!r}; a URDF's types are {', '.join(sorted(JOINT_TYPES))}"
    yield from _origin_faults(joint, f"joint {name!r}")
    normal = joint.find("axis")
    if kind == "planar" and normal is not None and any((numbers(normal.get("xyz", ""), 3) or (1.0,))[:2]):
        yield (
            f"the planar joint {name!r} has the axis {normal.get('xyz')!r}, and moves in the x-y plane of its origin "
            "alone; turn the origin and give the axis '0 0 1'"
        )
    if joint.find("limit") is None and kind in ("revolute", "prismatic"):
        yield f"the {kind} joint {name!r} has no <limit>; give its effort and velocity"
    limit = joint.find("limit")
    for key in ("effort", "velocity") if limit is not None and kind in MOVING else ():
        if limit is not None and key not in limit.attrib:
            yield f"joint {name!r} has a <limit> without {key}; give it"
    axis = joint.find("axis")
    if axis is not None and kind in MOVING and not any(numbers(axis.get("xyz", ""), 3) or ()):
        yield f"joint {name!r} has the axis {axis.get('xyz')!r}; give three numbers, not all zero"
    for field, keys in JOINT_NUMBERS.items():
        element = joint.find(field)
        for full, text in {} if element is None else element.attrib.items():
            key = local(full)
            if key not in keys:
                continue
            if not numbers(text, 1):
                yield f"joint {name!r} has <{field} {key}={text!r}>, which is no finite number"
            elif field == "limit" and key not in ("lower", "upper") and float(text) < 0:
                yield f"joint {name!r} has the {key} limit {text}; give a magnitude, 0 or more"


def _link_faults(link: Element) -> Iterator[str]:
    name = link.get("name")
    yield from _origin_faults(link, f"link {name!r}")
    inertial = link.find("inertial")
    if inertial is None:
        return
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    text = "" if mass is None else mass.get("value", "")
    value = numbers(text, 1)
    if value is None or value[0] < 0:
        yield f"link {name!r} has the mass {text!r}; give kilograms, 0 or more"
    if inertia is None:
        yield f"link {name!r} has an <inertial> without <inertia>; give its six numbers"
        return
    for key in INERTIA:
        entry = inertia.get(key, "")
        if numbers(entry, 1) is None:
            yield f"link {name!r} has the inertia {key}={entry!r}; give a finite number [kg m^2]"


def _origin_faults(owner: Element, what: str) -> Iterator[str]:
    """Yield the origins of a joint or link, of its inertia and of its shapes that are no three numbers."""
    for origin in owner.iter("origin"):
        for key, text in origin.attrib.items():
            found = numbers(text, 3)
            if key in ("xyz", "rpy") and (found is None or max(map(abs, found)) > LARGEST):
                yield f"{what} has an origin with {key}={text!r}; give three finite numbers up to {LARGEST:g}"


def _joint_findings(joint: Element) -> Iterator[str]:
    name, limit = joint.get("name"), joint.find("limit")
    if joint.get("type") not in MOVING or limit is None:
        return
    size = float(limit.get("velocity", "0"))
    if size and size < UNLIMITED and not SPEEDS[0] <= size <= SPEEDS[1]:
        yield f"Joint {name!r} has the implausible velocity limit {size:g}. Correct it with limits={{'velocity': ...}}."


def _link_findings(links: Iterable[Element]) -> Iterator[str]:
    """Yield the links whose inertia no rigid body can have; one call computes the eigenvalues of all."""
    found = [(link, link.find("inertial/inertia"), link.find("inertial/mass")) for link in links]
    heavy = [(link, inertia, mass) for link, inertia, mass in found if inertia is not None and mass is not None]
    if not heavy:
        return
    entries = np.array([[float(inertia.get(key, "0")) for key in INERTIA] for _, inertia, _ in heavy])
    moments = principal_moments(entries[:, FULL].reshape(-1, 3, 3))
    for (link, _, mass), own in zip(heavy, moments, strict=True):
        kilograms = float(mass.get("value", "0"))
        fault = triangle_fault(own, kilograms)
        if not kilograms and own.any():
            fault = f"the principal moments of inertia {', '.join(f'{each:.4g}' for each in own)} kg m^2 but no mass"
        if fault:
            yield f"Link {link.get('name')!r} has {fault}. No rigid body has such an inertia: correct the URDF."


def numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Return the finite numbers of an attribute, or None where there are not ``count`` of them."""
    try:
        values = tuple(map(float, text.split()))
    except ValueError:
        return None
    # float() takes underscores between digits, which no parser of URDFs does.
    readable = len(values) == count and all(map(math.isfinite, values)) and "_" not in text
    return values if readable else None
