"""Sources of robots: a name, a URDF file, a pin.Model or a RobotWrapper, each read into a Description."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj._util.paths import input_path
from robotraj._util.values import dataclass
from robotraj.robot.coupling.coupled_model import uncoupled
from robotraj.robot.coupling.mimics import Mimic, mimics_of, read_mimics
from robotraj.robot.known_robots.catalogue import find
from robotraj.robot.known_robots.entry import KnownRobot
from robotraj.robot.loading.chain_names import Chains
from robotraj.robot.loading.geometry import NoGeometry, UrdfGeometry
from robotraj.robot.loading.inertia import check_bodies
from robotraj.robot.loading.missing_meshes import missing_meshes
from robotraj.robot.loading.packages import search_folders
from robotraj.robot.loading.planning_model import names_of
from robotraj.robot.meshes.reading import SUFFIXES
from robotraj.robot.mjcf.model import is_mjcf, read_mjcf
from robotraj.robot.urdf.balls import chains_of_balls, without_balls
from robotraj.robot.urdf.limits import StatedLimits, stated_limits
from robotraj.robot.urdf.numbers import check_numbers
from robotraj.robot.urdf.springs import stated_springs
from robotraj.robot.urdf.structure import check_structure
from robotraj.robot.urdf.xml import read_model


@dataclass(frozen=True)
class Description:
    """A robot as it was given, before it is made ready for planning.

    Attributes
    ----------
    name : str
        Name for printing.
    model : pinocchio.Model
        The model as read, its joints independent; never written to.
    geometry : UrdfGeometry, NoGeometry or pair of pinocchio.GeometryModel
        The shapes or their source.
    mimics : tuple of Mimic
        Couplings of joints.
    srdf : Path or None
        File of reference configurations and rotors.
    actuated : tuple of str or None
        Joints with a motor, None for all.
    moving : tuple of str
        Beginnings of the names of joints that move, empty for all.
    end_effector : str or None
        Frame whose path replays draw.
    origin : str
        Source of the robot, for printing.
    findings : tuple of str
        Implausible numbers of the URDF, one sentence each.
    stated : StatedLimits
        Limits of the URDF beside those of the model.
    known : bool
        Whether the catalogue lists it. Its findings are notes without a warning.
    springs : mapping of str to (float, float)
        Stiffness and position without torque by joint [N m/rad, rad; N/m, m].
    chains : mapping of str to tuple of str
        Single joints in place of those of several degrees of freedom, by name.
    """

    name: str
    model: pin.Model
    geometry: UrdfGeometry | NoGeometry | tuple[pin.GeometryModel, pin.GeometryModel]
    origin: str
    mimics: tuple[Mimic, ...] = ()
    srdf: Path | None = None
    actuated: tuple[str, ...] | None = None
    moving: tuple[str, ...] = ()
    end_effector: str | None = None
    findings: tuple[str, ...] = ()
    stated: StatedLimits = StatedLimits({})
    known: bool = False
    springs: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    chains: Chains = field(default_factory=dict)


def describe(
    source: str | os.PathLike[str] | pin.Model | pin.RobotWrapper,
    package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    trust_paths: bool = False,
) -> Description:
    """Read the source.

    Raises
    ------
    InputError
        A source of another kind, an unreadable file, an unknown name.
    """
    folders = _folders(package_dirs)
    if isinstance(source, pin.Model):
        return Description(source.name or "robot", uncoupled(source), NoGeometry(), "a pin.Model", mimics_of(source))
    if isinstance(getattr(source, "model", None), pin.Model) and hasattr(source, "visual_model"):
        return _wrapper(source)
    if isinstance(source, str) and "://" in source:
        raise InputError(f"rt.load reads a file of this machine; {source!r} is an address. Give the path of the file.")
    if isinstance(source, os.PathLike) or (isinstance(source, str) and _is_path(source)):
        path = input_path(source, "The robot")
        if path.suffix.lower() in SUFFIXES:
            raise InputError(f"{str(path)!r} is a mesh, one shape; give the URDF or MJCF file whose links name meshes.")
        if is_mjcf(path):
            return _from_mjcf(path, None if trust_paths else search_folders(path, folders))
        return _from_urdf(KnownRobot("", "", str(path), path), folders, trust_paths)
    if isinstance(source, str):
        return _from_urdf(find(source), folders, trust_paths=True)
    raise InputError(
        "rt.load takes a robot's name, the path of a URDF file, a pin.Model or a pin.RobotWrapper; "
        f"got {type(source).__name__}."
    )


def _folders(package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> tuple[Path, ...]:
    """Return absolute folders: another working folder later does not change them."""
    given = (package_dirs,) if isinstance(package_dirs, (str, os.PathLike)) else tuple(package_dirs)
    found = tuple(input_path(folder, "package_dirs=").resolve() for folder in given)
    for folder, path in zip(given, found, strict=True):
        if not path.is_dir():
            raise InputError(
                f"package_dirs= names {str(folder)!r}, which is no folder; name the one above the package."
            )
    return found


def _is_path(text: str) -> bool:
    """Whether a text is a path rather than a name: names of robots have neither folders nor suffixes."""
    return "/" in text or os.sep in text or text in (os.curdir, os.pardir) or bool(os.path.splitext(text)[1])


def _wrapper(wrapper: pin.RobotWrapper) -> Description:
    visual, collision = wrapper.visual_model, wrapper.collision_model
    shapes = (visual or pin.GeometryModel(), collision or pin.GeometryModel())
    model = wrapper.model
    return Description(model.name or "robot", uncoupled(model), shapes, "a RobotWrapper", mimics_of(model))


def _from_mjcf(path: Path, folders: Sequence[Path] | None) -> Description:
    found = read_mjcf(path, folders)
    check_bodies(repr(str(path)), found.model)
    return Description(
        found.model.name or path.stem,
        found.model,
        found.shapes,
        str(path),
        found.mimics,
        actuated=found.actuated,
        findings=found.findings,
        stated=StatedLimits({"effort": found.efforts}),
        springs=found.springs,
        chains=found.chains,
    )


def _from_urdf(entry: KnownRobot, folders: tuple[Path, ...], trust_paths: bool) -> Description:
    geometry = UrdfGeometry(entry.urdf, folders, trust_paths)
    root, file = geometry.root, repr(str(entry.urdf))
    check_structure(file, root)
    findings = check_numbers(file, root)
    chains = chains_of_balls(root)
    root = without_balls(root)
    model = read_model(root, entry.urdf)
    check_bodies(file, model)
    return Description(
        entry.name or model.name or entry.urdf.stem,
        model,
        geometry,
        entry.source,
        read_mimics(root, names_of(model)[1:]),
        entry.srdf,
        entry.actuated,
        entry.moving,
        entry.end_effector,
        tuple(filter(None, (*findings, missing_meshes(root, entry.urdf, folders, trust_paths)))),
        stated_limits(root),
        bool(entry.name),
        stated_springs(root),
        chains,
    )
