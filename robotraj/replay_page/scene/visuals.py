"""The visual geometry of a robot: coloured parts, each fixed to a joint."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError, warn
from robotraj._util.paths import cache_folder
from robotraj._util.printing import OneLine
from robotraj._util.system.cached_arrays import keep
from robotraj._util.system.limited import LimitedProcess, NoAnswer
from robotraj._util.system.regular_files import contents
from robotraj._util.values import dataclass
from robotraj.replay_page.scene.part import Color, Part, unpacked
from robotraj.replay_page.scene.shapes import rod, shape_part
from robotraj.robot.meshes.reading import LARGEST, SUFFIXES

DEFAULT_COLOR: Color = (0.75, 0.77, 0.80, 1.0)
LINK_COLOR: Color = (0.36, 0.45, 0.56, 1.0)
UNNAMED_COLOR: Color = (0.9, 0.9, 0.9, 1.0)
"""Pinocchio's own default, which marks geometry that the URDF gives no colour."""
SECONDS, PER_BYTE = 4.0, 3e-7
"""Processor time for a file [s], and for each of its bytes."""
MOST_BYTES = 32 * 10**6
"""Largest size of the parts of a file, above that of as many triangles as a page shows."""
VERSION = 1
"""Version of the cached files."""


@dataclass(frozen=True)
class Visual(OneLine):
    """Parts under one fixed transform of a joint's frame.

    Attributes
    ----------
    joint : int
        Index of the joint in ``pin.Model``; 0 is the world.
    name : str
        The geometry's name.
    placement : (4, 4) array
        Transform from the parts' frame to the joint's, including mesh scale; that of a mirrored mesh has a negative
        determinant.
    parts : tuple of (Part, Color)
    """

    joint: int
    name: str
    placement: NDArray[np.float64]
    parts: tuple[tuple[Part, Color], ...]

    def corners(self) -> NDArray[np.float64]:
        """Corners (8 n, 3) [m] of the parts' boxes, in the joint's frame."""
        boxes = []
        for part, _ in self.parts:
            low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
            pick = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, 8).T
            boxes.append(np.where(pick == 0, low, high))
        return np.concatenate(boxes) @ self.placement[:3, :3].T + self.placement[:3, 3]


def visuals_of(model: pin.Model, geometry: pin.GeometryModel | None) -> tuple[Visual, ...]:
    """Collect the visuals of a robot; a model that has none is drawn as capsules between its joints.

    Colours are the URDF's where it names a material, else the mesh file's own, else Pinocchio's default.
    """
    found = []
    files = _file_parts(geometry) if geometry is not None else {}
    for thing in geometry.geometryObjects if geometry is not None else ():
        visual = _visual(thing, files.get(thing.meshPath, ()))
        if visual is not None:
            found.append(visual)
    return tuple(found) or skeleton(model)


def _visual(thing: pin.GeometryObject, parts: Parts) -> Visual | None:
    placement = np.array(thing.placement.homogeneous)
    if parts:
        placement = placement @ np.diag([*np.asarray(thing.meshScale, dtype=float).ravel(), 1.0])
    else:
        try:
            part = shape_part(thing.geometry)
        except LookupError as error:
            warn(f"The replay omits {thing.name!r}: it cannot draw a {error.args[0]}.")
            return None
        if part is None:
            return None
        parts = (part,)
    given: Color = tuple(float(c) for c in np.asarray(thing.meshColor).ravel())  # type: ignore[assignment]
    fallback = DEFAULT_COLOR if np.allclose(given, UNNAMED_COLOR) else given
    colored = tuple((p, given if thing.overrideMaterial else p.color or fallback) for p in parts)
    return Visual(int(thing.parentJoint), str(thing.name), placement, colored)


def _file_parts(geometry: pin.GeometryModel) -> dict[str, Parts]:
    """Read the parts of the mesh files; without them, Pinocchio's mesh is drawn in one colour."""
    found = {}
    files = [thing.meshPath for thing in geometry.geometryObjects if os.path.isfile(thing.meshPath)]
    for path, parts in read_meshes(files).items():
        if isinstance(parts, str):
            warn(f"The replay draws {path} without its materials: {parts}")
        else:
            found[path] = parts
    return found


def skeleton(model: pin.Model) -> tuple[Visual, ...]:
    """Draw capsules from each joint to its children, from the last ones to their farthest frame."""
    reach = [float(np.linalg.norm(placement.translation)) for placement in model.jointPlacements[1:]]
    size = sum(reach) + sum(float(np.linalg.norm(inertia.lever)) for inertia in model.inertias[1:])
    radius = 0.02 * size / max(len(reach), 1) if size > 0.0 else 0.02
    radius = float(np.clip(radius * 2.0, 0.005, 0.06))
    found = []
    for joint in range(model.njoints):
        children = [c for c in range(1, model.njoints) if model.parents[c] == joint]
        ends = [np.array(model.jointPlacements[c].translation) for c in children]
        if joint > 0 and not children:
            tips = [np.array(f.placement.translation) for f in model.frames if f.parentJoint == joint]
            tips.append(np.array(model.inertias[joint].lever))
            ends = [max(tips, key=lambda p: float(np.linalg.norm(p)))]
        parts = [rod(np.zeros(3), end, radius) for end in ends]
        if joint > 0:
            parts.append(rod(np.zeros(3), np.zeros(3), 1.6 * radius))
        colored = tuple((p, LINK_COLOR) for p in parts if p is not None)
        if colored:
            found.append(Visual(joint, f"{model.names[joint]} link", np.eye(4), colored))
    return tuple(found)


Parts = tuple[Part, ...]


def read_meshes(paths: Iterable[str]) -> dict[str, Parts | str]:
    """Return the parts of mesh files, or the reason why a file is not read."""
    found: dict[str, Parts | str] = {}
    with LimitedProcess("robotraj.replay_page.scene") as process:
        for path in dict.fromkeys(paths):
            try:
                found[path] = _read(Path(path), process)
            except (InputError, NoAnswer, ValueError) as error:
                found[path] = str(error).rstrip(".")
    return found


def _read(path: Path, process: LimitedProcess) -> Parts:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"the format {suffix or 'without a suffix'} is none of {', '.join(SUFFIXES)}")
    data = contents(path, LARGEST, "the file")
    kept = cache_folder("parts") / f"{hashlib.sha256(suffix.encode() + data).hexdigest()[:40]}-{VERSION}.npz"
    # An entry that is missing or damaged is read from the mesh again.
    with suppress(InputError, ValueError):
        return unpacked(contents(kept, MOST_BYTES))[0]
    head = json.dumps([suffix, str(path.absolute().parent)]).encode()
    answer = process.ask(head + b"\n" + data, SECONDS + PER_BYTE * len(data))
    parts, alone = unpacked(answer)
    if alone and len(answer) <= MOST_BYTES:
        keep(kept, answer)
    return parts
