"""A meshcat window that keeps the commands in memory: no server, port, process or browser."""

from __future__ import annotations

import gzip
import hashlib
import struct
import uuid
from typing import Protocol, cast

import meshcat
import numpy as np
import umsgpack
from meshcat.animation import AnimationTrack
from meshcat.geometry import Geometry, Mesh, MeshPhongMaterial
from numpy.typing import NDArray

from robotraj.replay_page.scene.part import Color, Part

LEVEL = 5
"""Level of compression; higher ones take thrice the time for a page that is less than 0.1 % smaller."""
_EXTENSIONS = {
    "uint16": ("Uint16Array", 0x14),
    "uint32": ("Uint32Array", 0x16),
    "float32": ("Float32Array", 0x17),
}


class Command(Protocol):
    """A command of meshcat."""

    def lower(self) -> dict[str, object]:
        """Return the data of the command."""
        ...


class RecordingWindow:
    """Records the commands of a ``meshcat.Visualizer(window=...)`` in order.

    A geometry that was sent before is recorded as a reference to its uuid, so that a mesh used twice is stored once.
    """

    def __init__(self) -> None:
        self.commands: list[dict[str, object]] = []
        self._seen: set[object] = set()

    def send(self, command: Command) -> None:
        """Record one meshcat command."""
        data = command.lower()
        if data["type"] == "set_object":
            shown = cast("dict[str, list[dict[str, object]]]", data["object"])
            shown["geometries"] = [self._once(g) for g in shown.get("geometries", [])]
        self.commands.append(data)

    def _once(self, geometry: dict[str, object]) -> dict[str, object]:
        if geometry["uuid"] in self._seen:
            return {"uuid": geometry["uuid"], "type": "shared"}
        self._seen.add(geometry["uuid"])
        return geometry

    def packed(self) -> bytes:
        """Compress all commands: for each its length (4 bytes, little endian) and its msgpack, in float32."""
        packets = [umsgpack.packb(command, force_float_precision="single") for command in self.commands]
        return gzip.compress(b"".join(struct.pack("<I", len(p)) + p for p in packets), LEVEL, mtime=0)


class Surface(Geometry):
    """A part as a three.js BufferGeometry; equal parts get equal uuids.

    Normals are left to the page, which computes them from the shared vertices.
    """

    def __init__(self, part: Part) -> None:
        super().__init__()
        self.part = part
        content = hashlib.sha1(part.vertices.tobytes() + part.faces.tobytes(), usedforsecurity=False)
        self.uuid = str(uuid.UUID(bytes=content.digest()[:16]))

    def lower(self, object_data: dict[str, object]) -> dict[str, object]:
        """Describe the geometry in three.js's JSON, with binary arrays."""
        return {
            "uuid": self.uuid,
            "type": "BufferGeometry",
            "data": {
                "attributes": {"position": _array(self.part.vertices, 3)},
                "index": _array(self.part.faces.reshape(-1, 1), 1),
            },
        }


class PackedTrack(AnimationTrack):
    """An animation track whose keys are two float32 arrays, which three.js uses without conversion.

    Parameters
    ----------
    name, jstype : str
        Property and three.js type: ``"position"``, ``"vector3"``.
    frames : (k,)
        Key times in frames.
    values : (k, 3) or (k, 4)
    """

    def lower(self) -> dict[str, object]:
        """Describe the track in three.js's JSON, with binary arrays."""
        return {"name": f".{self.name}", "type": self.jstype} | {
            key: umsgpack.Ext(0x17, np.asarray(values, dtype=np.float32).tobytes("C"))
            for key, values in (("times", self.frames), ("values", self.values))
        }


def _array(values: NDArray[np.generic], size: int) -> dict[str, object]:
    kind, code = _EXTENSIONS[values.dtype.name]
    return {
        "itemSize": size,
        "type": kind,
        "array": umsgpack.Ext(code, values.tobytes("C")),
        "normalized": False,
    }


def draw(node: meshcat.Visualizer, part: Part, color: Color, shininess: float = 25.0) -> None:
    """Put one part in one colour at a node, seen from both sides."""
    red, green, blue, opacity = (float(np.clip(c, 0.0, 1.0)) for c in color)
    code = (round(255 * red) << 16) + (round(255 * green) << 8) + round(255 * blue)
    material = MeshPhongMaterial(color=code, opacity=opacity, shininess=shininess)
    mesh = Mesh(Surface(part), material)
    name = node.path.lower()
    material.uuid = str(uuid.uuid5(uuid.NAMESPACE_URL, name + "#material"))
    mesh.uuid = str(uuid.uuid5(uuid.NAMESPACE_URL, name))
    node.set_object(mesh)
