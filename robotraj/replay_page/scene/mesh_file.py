"""Contents of mesh files as coloured parts, by trimesh."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import contents
from robotraj.replay_page.scene.part import Color, Part, merge_by_color
from robotraj.replay_page.scene.simplify import simplified

LARGEST = 32 * 10**6
"""Largest size of a texture [bytes]."""
MOST_COLORS = 24
"""Largest number of colours of a mesh that is coloured face by face; with more it has their mean."""


class Beside(trimesh.resolvers.FilePathResolver):
    """Materials and textures that a mesh names: regular files, by paths that start at its folder.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(str(folder))
        self._folder, self.opened = folder, 0

    def get(self, name: str) -> bytes:
        """Return the content of a file in the folder or below it.

        Raises
        ------
        InputError
            There is none.
        """
        self.opened += 1
        inside = self._folder.resolve()
        for each in (name, name.lstrip("/"), Path(name).name):
            path = Path(os.path.realpath(inside / each.strip()))
            if path.is_relative_to(inside) and path.is_file():
                return contents(path, LARGEST, "the texture")
        raise InputError(f"There is no {name!r} in the folder of the mesh.")


def parts_of(data: bytes, suffix: str, beside: Beside) -> tuple[Part, ...]:
    """Read the content of a mesh file: one welded part for each colour, in the frame of the file.

    Node transforms inside the file are applied; its unit and up axis are not, as in Pinocchio's own loader.

    Parameters
    ----------
    data : bytes
    suffix : str
        Format, such as ``".dae"``.
    beside : Beside

    Returns
    -------
    tuple of Part
        ``color`` is None where the file has no material. The tuple is empty if the file has no triangle.
    """
    scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix[1:], resolver=beside)
    pieces: list[tuple[NDArray[np.float64], NDArray[np.integer], Color | None]] = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh):
            continue
        vertices = np.asarray(mesh.vertices) @ transform[:3, :3].T + transform[:3, 3]
        faces = np.asarray(mesh.faces)
        if np.linalg.det(transform[:3, :3]) < 0.0:
            faces = faces[:, ::-1]
        for color, mask in _colors(mesh):
            pieces.append((*simplified(vertices, faces[mask]), color))
    return merge_by_color(pieces)


def _colors(mesh: trimesh.Trimesh) -> list[tuple[Color | None, NDArray[np.bool_] | slice]]:
    """Return the colours of a mesh, each with its faces (a mask or slice)."""
    visual, everything = mesh.visual, slice(None)
    if not visual.defined:
        return [(None, everything)]
    if visual.kind == "texture":
        return [(_material_color(visual.material), everything)]
    rgba = np.asarray(visual.face_colors)
    distinct, index = np.unique(rgba, axis=0, return_inverse=True)
    if len(distinct) > MOST_COLORS:
        return [(_color(rgba.mean(axis=0)), everything)]
    return [(_color(c), index.ravel() == i) for i, c in enumerate(distinct)]


def _material_color(material: trimesh.visual.material.Material) -> Color | None:
    """Read the base colour of a material, times the mean of its texture; None if the file gave none."""
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if image is None and isinstance(material, trimesh.visual.material.SimpleMaterial) and not material.kwargs:
        return None
    rgba = np.asarray(material.main_color, dtype=float)
    if image is not None:
        rgba = rgba * np.asarray(image.convert("RGBA").resize((1, 1)).getpixel((0, 0))) / 255.0
    return _color(rgba)


def _color(rgba: NDArray[np.generic]) -> Color:
    """Round a colour from 0 to 255 to 8 bits, and scale it to [0, 1]."""
    red, green, blue, opacity = (float(np.rint(c)) / 255.0 for c in rgba)
    return (red, green, blue, opacity if opacity > 0.0 else 1.0)
