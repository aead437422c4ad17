"""The process that reads mesh files: a suffix and the bytes of a file come in, its arrays go out."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np

from robotraj._util.system.limited import serve
from robotraj.robot.meshes.arrays import MOST_TRIANGLES, MeshArrays

NESTED = (".dae", ".glb")
"""Formats with a tree of nodes: coal's loader mixes up the corners where a node has several meshes, or children."""
MANY = 50_000
"""Triangles from which those that lie on another are left out."""


def _arrays(question: bytes) -> bytes:
    suffix, _, data = question.partition(b"\n")
    name = suffix.decode()
    mesh = _by_trimesh(data, name) if name in NESTED else _by_coal(data, name)
    mesh = _distinct(mesh) if len(mesh.triangles) > MANY else mesh
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    if not np.any(np.cross(b - a, c - a)):
        raise ValueError("its triangles have no area")
    return mesh.packed()


def _distinct(mesh: MeshArrays) -> MeshArrays:
    """Return a mesh with each triangle once, whatever its first corner and its side."""
    vertices, owner = np.unique(mesh.vertices, axis=0, return_inverse=True)
    corners = owner.reshape(-1)[mesh.triangles]
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    return MeshArrays(vertices, corners[np.sort(first)].astype(np.int32))


def _by_coal(data: bytes, suffix: str) -> MeshArrays:
    import coal

    if suffix == ".obj":
        # Materials are other files, which could be pipes, and split a mesh.
        lines = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
        data = re.sub(rb"(?m)^[ \t]*(mtllib|usemtl)[^\n]*", b"", lines)
    file = Path(f"mesh{suffix}")
    file.write_bytes(data)
    try:
        # The tree of boxes is not used, and this one is built soonest.
        mesh = coal.MeshLoader(coal.BV_AABB).load(str(file), np.ones(3))
    except ValueError as error:  # with the place in its own source
        reason = str(error).rpartition("message: ")[2].partition("Hint:")[0]
        raise ValueError(reason.replace(f"file {file}", "it").replace(f"resource {file}", "it:")) from error
    finally:
        file.unlink()
    count = int(mesh.num_tris)
    if count > MOST_TRIANGLES:
        raise ValueError(f"it has {count} triangles; 1 to {MOST_TRIANGLES} are read")
    corners = [(found[0], found[1], found[2]) for found in map(mesh.tri_indices, range(count))]
    return MeshArrays(np.array(mesh.vertices()), np.array(corners, dtype=np.int32).reshape(-1, 3))


def _by_trimesh(data: bytes, suffix: str) -> MeshArrays:
    import trimesh

    # Its reader of COLLADA takes zero for what is no number.
    for numbers in re.findall(rb"<float_array[^>]*>([^<]*)", data) if suffix == ".dae" else ():
        if re.search(rb"[^-+.0-9eE\s]", numbers):
            raise ValueError("a coordinate is no number")
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix[1:], process=False)
    except ModuleNotFoundError as error:  # it looks for a package that guesses encodings
        raise ValueError("its text is not UTF-8") from error
    vertices, triangles, count, total = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0, 0
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if isinstance(mesh, trimesh.Trimesh):
            total += len(mesh.faces)
            if total > MOST_TRIANGLES:
                raise ValueError(f"it has more than {MOST_TRIANGLES} triangles")
            vertices.append(np.asarray(mesh.vertices, dtype=float) @ transform[:3, :3].T + transform[:3, 3])
            triangles.append(np.asarray(mesh.faces, dtype=np.int64) + count)
            count += len(mesh.vertices)
    return MeshArrays(np.concatenate(vertices), np.concatenate(triangles).astype(np.int32))


if __name__ == "__main__":
    serve(_arrays)
