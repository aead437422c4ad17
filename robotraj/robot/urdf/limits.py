"""Limits of a URDF that Pinocchio does not read, and the attributes that nobody reads.

Pinocchio reads ``lower``, ``upper``, ``velocity`` and ``effort`` of ``<limit>``. URDF 1.2 adds ``acceleration`` and
``jerk``, and Drake writes ``drake:acceleration``. The soft limits of ``<safety_controller>`` are those at which the
controller of the joint brakes. Source: the XML specification of URDF, wiki.ros.org/urdf/XML/joint.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from xml.etree.ElementTree import Element

from robotraj._util.values import dataclass
from robotraj.robot.urdf.lenient import calls
from robotraj.robot.urdf.springs import SPRING
from robotraj.robot.urdf.structure import SHOWN

MADE_OF = ("acceleration", "jerk")
"""Quantities of ``<limit>`` that Pinocchio ignores."""
BOUNDED = ("revolute", "prismatic")
"""Joint types whose positions need limits."""
UNLIMITED_TYPES = ("planar", "floating")
"""Joint types with several velocities of different units, which a single ``<limit>`` cannot bound."""
READ: Mapping[str, Sequence[str]] = {
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "velocity", "effort", *MADE_OF),
    "dynamics": ("damping", "friction", *SPRING),
    "mimic": ("joint", "multiplier", "offset"),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"),
    "calibration": ("rising", "falling", "reference_position"),
    "inertial": (),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
}
"""Attributes of the elements of joints and inertias that are read, or that have no effect on a plan."""
TURNS, DEGREES = 4.0 * math.pi, 720.0
"""A position limit or a turn of an origin between these magnitudes is more plausible in degrees than in rad."""
LOOPS = ("loop_joint",)
"""Elements below ``<robot>`` that close loops in dialects of URDF."""

Pair = tuple[float, float]


@dataclass(frozen=True)
class StatedLimits:
    """Limits of a URDF beside those that Pinocchio reads.

    Attributes
    ----------
    pairs : mapping
        Lower and upper limit by quantity and joint [SI unit].
    missing : tuple of str
        Joints whose type needs position limits and that state none.
    """

    pairs: Mapping[str, Mapping[str, Pair]]
    missing: tuple[str, ...] = ()


def stated_limits(root: Element) -> StatedLimits:
    """Read the accelerations, jerks and soft limits of all joints, whose numbers have been checked."""
    pairs: dict[str, dict[str, Pair]] = {}
    missing = []
    for joint in root.findall("joint"):
        name, limit = joint.get("name", ""), joint.find("limit")
        if limit is None:
            continue
        for quantity in MADE_OF:
            text = next((text for key, text in limit.attrib.items() if local(key) == quantity), None)
            if text is not None:
                pairs.setdefault(quantity, {})[name] = (-float(text), float(text))
        if joint.get("type") in BOUNDED and not {"lower", "upper"} & limit.attrib.keys():
            missing.append(name)
        soft = _soft(joint)
        if soft is not None and soft[0] < soft[1]:
            pairs.setdefault("position", {})[name] = soft
    return StatedLimits(pairs, tuple(missing))


def limit_findings(root: Element) -> Iterator[str]:
    """Yield a sentence on macros and attributes that are not read, useless soft limits, and positions in degrees."""
    unread: dict[str, None] = {}
    for owner in (*root.findall("joint"), *root.findall("link/inertial")):
        for element in (owner, *owner):
            known = READ.get(element.tag)
            unread |= {
                f"<{element.tag} {key}>": None for key in element.attrib if known is None or local(key) not in known
            }
    if undefined := calls(root):
        yield f"Macros that the file does not define are left out: {', '.join(f'<{each}>' for each in undefined)}."
    loops = [each.get("name", "") for tag in LOOPS for each in root.findall(tag)]
    if loops:
        yield (
            f"Joints that close loops are not read: {', '.join(map(repr, loops))}. Close them with "
            "rt.contacts.LoopClosure."
        )
    several = [
        repr(joint.get("name", ""))
        for joint in root.findall("joint")
        if joint.get("type") in UNLIMITED_TYPES and joint.find("limit") is not None
    ]
    if several:
        yield f"A <limit> of planar and floating joints is not read: {', '.join(several)}. Give it with limits=."
    if unread:
        yield f"Attributes that robotraj does not read: {', '.join(unread)}."
    useless = [
        joint.get("name", "")
        for joint in root.findall("joint")
        if (soft := _soft(joint)) is not None and not soft[0] < soft[1]
    ]
    if useless:
        yield f"Soft limits that leave no motion are not used: {', '.join(map(repr, useless))}."
    turned = [
        joint
        for joint in root.findall("joint")
        if joint.get("type") == "revolute" and (limit := joint.find("limit")) is not None and _in_degrees(limit)
    ]
    if turned:
        first, names = turned[0].find("limit"), ", ".join(repr(joint.get("name", "")) for joint in turned)
        assert first is not None
        yield (
            f"Position limits in rad that are plausible in degrees: {names} (the first has "
            f"[{first.get('lower', '0')}, {first.get('upper', '0')}]). Correct them with limits={{'position': ...}}."
        )
    turns = dict.fromkeys(origin.get("rpy", "") for origin in root.iter("origin"))
    tilted = [repr(rpy) for rpy in turns if any(TURNS < abs(float(angle)) <= DEGREES for angle in rpy.split())]
    if tilted:
        yield f"Origins with rpy in rad that is plausible in degrees: {', '.join(tilted[:SHOWN])}. Correct the file."


def _soft(joint: Element) -> Pair | None:
    """Return the position limits of a joint within its soft limits, None if they are no tighter than its own."""
    limit, soft = joint.find("limit"), joint.find("safety_controller")
    if limit is None or soft is None or joint.get("type") not in BOUNDED:
        return None
    own = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    low = max(own[0], float(soft.get("soft_lower_limit", "-inf")))
    high = min(own[1], float(soft.get("soft_upper_limit", "inf")))
    return (low, high) if (low, high) != own else None


def _in_degrees(limit: Element) -> bool:
    return any(TURNS < abs(float(limit.get(side, "0"))) <= DEGREES for side in ("lower", "upper"))


def local(key: str) -> str:
    """Return the name of an attribute without its namespace, a prefix or ``{address}``."""
    return key.rpartition(":")[2].rpartition("}")[2]
