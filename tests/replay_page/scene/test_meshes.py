import os
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import trimesh

from robotraj._util.system.limited import LimitedProcess
from robotraj.robot.meshes.reading import read_mesh_file
from tests.replay_page.scene.parts import read_mesh

NAMESPACE = {"c": "http://www.collada.org/2005/11/COLLADASchema"}


def total_area(parts) -> float:
    return sum(trimesh.Trimesh(p.vertices.astype(float), p.faces, process=False).area for p in parts)


def files_of(robot) -> list[str]:
    return sorted({thing.meshPath for thing in robot.visual_model.geometryObjects if Path(thing.meshPath).is_file()})


def diffuse_colors(path: str) -> set[tuple[int, ...]]:
    """Diffuse colours, 0 to 255, of the materials that a .dae binds in its scene; read from its XML."""
    root = ET.parse(path).getroot()
    effects = {}
    for effect in root.iterfind(".//c:effect", NAMESPACE):
        text = effect.find(".//c:diffuse/c:color", NAMESPACE).text
        effects["#" + effect.get("id")] = tuple(int(255 * float(x) + 0.5) for x in text.split()[:3])
    materials = {
        "#" + m.get("id"): effects[m.find("c:instance_effect", NAMESPACE).get("url")]
        for m in root.iterfind(".//c:material", NAMESPACE)
    }
    bound = root.iterfind(".//c:visual_scene//c:instance_material", NAMESPACE)
    return {materials[b.get("target")] for b in bound}


def test_every_part_and_colour_of_ur5_survives(ur5):
    files = files_of(ur5)
    assert len(files) == 7
    for path in files:
        parts = read_mesh(path)
        found = {tuple(round(255 * c) for c in p.color[:3]) for p in parts}
        expected = diffuse_colors(path)
        assert len(expected) >= 2, path
        assert len(parts) == len(found)  # one part for each colour
        assert len(found) == len(expected), path
        for color in expected:
            assert min(max(abs(a - b) for a, b in zip(color, f, strict=True)) for f in found) <= 1, (
                path,
                color,
            )


@pytest.mark.parametrize("name", ["ur5", "talos", "double_pendulum"])
def test_surfaces_agree_with_pinocchios_own_loader(name, request):
    for path in files_of(request.getfixturevalue(name)):
        parts = read_mesh(path)
        loaded = read_mesh_file(Path(path))
        low = np.min([p.vertices.min(axis=0) for p in parts], axis=0)
        high = np.max([p.vertices.max(axis=0) for p in parts], axis=0)
        expected = [loaded.vertices.min(axis=0), loaded.vertices.max(axis=0)]
        np.testing.assert_allclose([low, high], expected, atol=2e-5)
        # Slivers without area are dropped.
        assert sum(len(p.faces) for p in parts) == pytest.approx(len(loaded.triangles), rel=0.02)
        own = trimesh.Trimesh(loaded.vertices, loaded.triangles, process=False)
        assert total_area(parts) == pytest.approx(own.area, rel=1e-3), path


def test_an_stl_names_no_colour(double_pendulum):
    for path in files_of(double_pendulum):
        assert [p.color for p in read_mesh(path)] == [None]


def test_an_obj_keeps_its_materials(tmp_path):
    (tmp_path / "two.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\nd 0.5\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "two.obj").write_text(f"mtllib two.mtl\n{corners}usemtl red\nf 1 2 3\nusemtl green\nf 1 2 4\n")
    colors = {tuple(round(c, 2) for c in p.color[:3]) for p in read_mesh(str(tmp_path / "two.obj"))}
    assert colors == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)}
    (tmp_path / "bare.obj").write_text(f"{corners}f 1 2 3\nf 1 2 4\n")
    assert [p.color for p in read_mesh(str(tmp_path / "bare.obj"))] == [None]


def test_colours_by_face_become_parts_and_many_become_their_mean(tmp_path):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.visual.face_colors = np.where(np.arange(len(mesh.faces))[:, None] < 100, [255, 0, 0, 255], [0, 0, 255, 255])
    mesh.export(tmp_path / "two.ply")
    parts = read_mesh(str(tmp_path / "two.ply"))
    assert sorted((len(p.faces), p.color) for p in parts) == [
        (100, (1.0, 0, 0, 1.0)),
        (220, (0, 0, 1.0, 1.0)),
    ]
    mesh.visual.face_colors = np.column_stack([np.arange(len(mesh.faces)) % 200, *[np.full(len(mesh.faces), 255)] * 3])
    mesh.export(tmp_path / "many.ply")
    (part,) = read_mesh(str(tmp_path / "many.ply"))
    assert 0.2 < part.color[0] < 0.5
    assert part.color[1:] == (1.0, 1.0, 1.0)


def test_a_mirrored_node_keeps_its_outside_outside(tmp_path):
    source = trimesh.creation.box(extents=[1.0, 2.0, 3.0])
    scene = trimesh.Scene()
    scene.add_geometry(source, transform=np.diag([1.0, -1.0, 1.0, 1.0]))
    scene.export(tmp_path / "mirrored.glb")
    (part,) = read_mesh(str(tmp_path / "mirrored.glb"))
    assert trimesh.Trimesh(part.vertices, part.faces).volume == pytest.approx(6.0, rel=1e-4)


def test_the_second_reading_needs_no_parser(ur5, monkeypatch):
    path = files_of(ur5)[0]
    first = read_mesh(path)
    monkeypatch.setattr(LimitedProcess, "ask", lambda *_: pytest.fail("read twice"))
    for one, other in zip(first, read_mesh(path), strict=True):
        assert one.color == other.color
        np.testing.assert_array_equal(one.vertices, other.vertices)
        np.testing.assert_array_equal(one.faces, other.faces)


def test_a_texture_that_is_a_pipe_or_a_device_is_not_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.mtl")
    for name in ("pipe.mtl", "/dev/zero", "../../../../../../dev/zero"):
        (tmp_path / "one.obj").write_text(f"mtllib {name}\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        assert [len(part.faces) for part in read_mesh(str(tmp_path / "one.obj"))] == [1]
