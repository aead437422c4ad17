"""Read a model of MuJoCo with Pinocchio's reader, and what that leaves out: motors, their limits, and springs."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import contents
from robotraj._util.values import dataclass
from robotraj.robot.coupling.mimics import Mimic, resolved
from robotraj.robot.loading.chain_names import Chains
from robotraj.robot.loading.single_axes import single_axes
from robotraj.robot.mjcf.checks import check_names, check_numbers
from robotraj.robot.mjcf.couplings import active, couplings
from robotraj.robot.mjcf.defaults import Attributes, with_defaults
from robotraj.robot.mjcf.includes import with_includes
from robotraj.robot.mjcf.inertias import with_inertias
from robotraj.robot.mjcf.meshes import PlainCopy
from robotraj.robot.mjcf.motors import motors_of
from robotraj.robot.mjcf.placement import with_plain_poses
from robotraj.robot.mjcf.trees import with_names, with_one_tree
from robotraj.robot.mjcf.unread import check_bodies, without_height_fields
from robotraj.robot.urdf.lenient import parsed
from robotraj.robot.urdf.numbers import numbers
from robotraj.robot.urdf.xml import MAX_BYTES

FLUID = ("density", "viscosity")
COMPOSITE = "Composite_"
"""Pinocchio's name of the joints of a body is this and the name of the first one."""


@dataclass(frozen=True)
class MjcfModel:
    """What is read of a file.

    Attributes
    ----------
    model : pinocchio.Model
    shapes : pair of pinocchio.GeometryModel
        For display and for collisions.
    actuated : tuple of str or None
        Joints with an actuator; None if the file has none at all.
    efforts : mapping by joint
        Lower and upper limits of the motors [N m, N].
    springs : mapping by joint
        Stiffness and position without torque [N m/rad, rad; N/m, m].
    findings : tuple of str
    chains : mapping of str to tuple of str
        Single joints in place of ball joints, by name.
    mimics : tuple of Mimic
        Joints that follow another one.
    """

    model: pin.Model
    shapes: tuple[pin.GeometryModel, pin.GeometryModel]
    actuated: tuple[str, ...] | None
    efforts: dict[str, tuple[float, float]]
    springs: dict[str, tuple[float, float]]
    findings: tuple[str, ...]
    chains: Chains
    mimics: tuple[Mimic, ...]


def is_mjcf(path: Path) -> bool:
    """Whether a file is XML whose top element is ``<mujoco>``."""
    if path.suffix.lower() not in (".xml", ".mjcf") or not os.path.isfile(path):
        return False
    try:
        return _root(path).tag == "mujoco"
    except ValueError:
        return False


def read_mjcf(path: Path, folders: Sequence[Path] | None) -> MjcfModel:
    """Read a file of MuJoCo.

    Parameters
    ----------
    path : Path
    folders : sequence of Path or None
        Folders whose meshes are read; None for all.

    Raises
    ------
    InputError
        Pinocchio's reader refuses it or drops elements of it, an included file or a mesh lies elsewhere, or cannot be
        read within the limits of such files.
    """
    root = _root(path)
    with_includes(root, path, folders)
    check_numbers(repr(str(path)), root)
    check_names(repr(str(path)), root)
    check_bodies(repr(str(path)), root)
    with_defaults(root)
    with_plain_poses(root)
    fields = without_height_fields(root)
    equalities, tendons = active(root), any(len(group) for group in root.findall("tendon"))
    model, shapes, beside = _built(root, path, folders)
    model, chains = with_single_axes(root, model, shapes)
    gravity = numbers(" ".join(each.get("gravity", "") for each in root.findall("option")).strip(), 3)
    if any(each.get("gravity") == "disable" for option in root.findall("option") for each in option.iter("flag")):
        gravity = (0.0, 0.0, 0.0)
    if gravity is not None:
        model.gravity.linear = np.array(gravity)
    joints = [model.names[i] for i in range(1, model.njoints)]
    coupled, others = couplings(equalities, model)
    mimics = resolved(coupled)
    constraining = [tag for tag, is_left in (("equality", others), ("tendon", tendons)) if is_left]
    motors = motors_of(root, joints, chains, mimics)
    stated = [joint.attrib for world in root.findall("worldbody") for joint in world.iter("joint")]
    springs, unread = joint_springs(root, stated, joints)
    findings = []
    weightless = [body.get("name", "") for body in root.iter("body") if body.get("gravcomp", "0") != "0"]
    if weightless:
        findings.append(
            f"Compensation of gravity (gravcomp) in the MJCF that is not read: {', '.join(map(repr, weightless))}."
        )
    if unread:
        findings.append(
            f"Springs of the MJCF that are not read: {', '.join(map(repr, unread))}. Set them with springs={{joint: "
            "(stiffness, rest)}."
        )
    if beside:
        findings.append(f"Bodies beside the robot in the MJCF that are not read: {', '.join(map(repr, beside))}.")
    fluid = [name for name in FLUID if any(float(each.get(name, "0")) > 0.0 for each in root.findall("option"))]
    if fluid:
        findings.append(f"Forces of a fluid in the MJCF that are not read: {' and '.join(fluid)} of <option>.")
    if fields:
        findings.append(f"Height fields of the MJCF that are not read: {', '.join(map(repr, fields))}.")
    if constraining:
        findings.append(f"Sections of the MJCF that are not read: {', '.join(f'<{tag}>' for tag in constraining)}.")
    findings += motors.findings
    return MjcfModel(model, shapes, motors.driven, motors.efforts, springs, tuple(findings), chains, mimics)


def _built(
    root: Element, path: Path, folders: Sequence[Path] | None
) -> tuple[pin.Model, tuple[pin.GeometryModel, pin.GeometryModel], tuple[str, ...]]:
    """Return the model, its shapes for display and for collisions, and the bodies of the file that are not in it."""
    with tempfile.TemporaryDirectory(prefix="robotraj-") as place:
        copy = PlainCopy(root, path, folders, Path(place))
        with_inertias(repr(str(path)), root, copy.meshes)
        beside = with_one_tree(root)
        with_names(root)
        copy.write()
        file = str(copy.file)
        try:
            model = pin.buildModelFromMJCF(file)
            visual = pin.buildGeomFromMJCF(model, file, pin.GeometryType.VISUAL)
            collision = pin.buildGeomFromMJCF(model, file, pin.GeometryType.COLLISION)
        except Exception as error:  # the reader raises errors of several libraries
            raise InputError(
                f"Pinocchio cannot read the MJCF {str(path)!r}: {error}. Give a URDF, or a pin.Model of your own."
            ) from error
    for shapes in (visual, collision):
        copy.name_sources(shapes)
    return model, (visual, collision), beside


def _root(path: Path) -> Element:
    return parsed(contents(path, MAX_BYTES, "The MJCF file"))


def with_single_axes(
    root: Element, model: pin.Model, shapes: tuple[pin.GeometryModel, pin.GeometryModel]
) -> tuple[pin.Model, Chains]:
    """Return the model with joints of one degree of freedom, and the names of balls' parts; move the shapes along.

    The joints of a body keep the names that the file gives them.
    """
    chained, chains = single_axes(model)
    if chained is model:
        return model, chains
    for group in shapes:
        for shape in group.geometryObjects:
            frame = model.frames[shape.parentFrame]
            shape.parentFrame = chained.getFrameId(frame.name, frame.type)
            shape.parentJoint = chained.frames[shape.parentFrame].parentJoint
    for old, new in _names(root):
        if chained.existJointName(old):
            frame = chained.frames[chained.getFrameId(old, pin.FrameType.JOINT)]
            frame.name = new
            chained.names[chained.getJointId(old)] = new
    return chained, {joint: parts for joint, parts in chains.items() if not joint.startswith(COMPOSITE)}


def _names(root: Element) -> Iterator[tuple[str, str]]:
    """Yield the names of the parts of each body's joints, and those of the file."""
    for body in root.iter("body"):
        names = [joint.get("name", "") for joint in body.findall("joint")]
        if len(names) > 1 and all(names):
            yield from ((f"{COMPOSITE}{names[0]}_{k}", name) for k, name in enumerate(names, 1))


def joint_springs(
    root: Element, joints: Iterable[Attributes], names: Iterable[str]
) -> tuple[dict[str, tuple[float, float]], tuple[str, ...]]:
    """Return stiffness and position without torque by joint [N m/rad, rad; N/m, m], and the springs that are not read.

    Springs of ball joints, several stiffnesses at one joint, and springs that are given by their natural frequency or
    beside another reference than zero are not read.

    Parameters
    ----------
    root : Element
    joints : iterable of attributes
        Of every joint of the file.
    names : iterable of str
        The joints of the model.
    """
    compiler, known = root.find("compiler"), set(names)
    degrees = compiler is None or compiler.get("angle", "degree") == "degree"
    found: dict[str, tuple[float, float]] = {}
    unread = []
    for joint in joints:
        name, kind = joint.get("name", ""), joint.get("type", "hinge")
        stiffness, rest = numbers(joint.get("stiffness", "0"), 1), numbers(joint.get("springref", "0"), 1)
        if "springdamper" not in joint and stiffness is not None and not stiffness[0] > 0.0:
            continue
        plain = kind in ("hinge", "slide") and "springdamper" not in joint and name in known
        zero = numbers(joint.get("ref", "0"), 1)
        if not plain or stiffness is None or rest is None or zero is None or zero[0] != 0.0:
            unread.append(name or "a joint without a name")
            continue
        found[name] = (stiffness[0], math.radians(rest[0]) if degrees and kind == "hinge" else rest[0])
    return found, tuple(unread)
