import gzip
import struct

import meshcat
import numpy as np
import umsgpack
from trimesh import creation

from robotraj.replay_page.scene.part import weld
from robotraj.replay_page.scene.window import RecordingWindow, draw


def unpack(data: bytes) -> list[dict]:
    raw, commands = gzip.decompress(data), []
    while raw:
        (length,) = struct.unpack_from("<I", raw)
        commands.append(umsgpack.unpackb(raw[4 : 4 + length]))
        raw = raw[4 + length :]
    return commands


def part(subdivisions: int = 1):
    mesh = creation.icosphere(subdivisions=subdivisions)
    return weld(mesh.vertices, mesh.faces)


def test_commands_come_back_in_order():
    window = RecordingWindow()
    viewer = meshcat.Visualizer(window=window)
    matrix = np.eye(4)
    matrix[:3, 3] = [1.0, 2.0, 3.0]
    viewer["a"].set_transform(matrix)
    draw(viewer["a/b"], part(), (1.0, 0.5, 0.0, 1.0))
    viewer["c"].set_property("visible", False)
    commands = unpack(window.packed())
    assert [c["type"] for c in commands] == ["set_transform", "set_object", "set_property"]
    assert [c["path"] for c in commands] == ["/meshcat/a", "/meshcat/a/b", "/meshcat/c"]
    assert commands[0]["matrix"][12:15] == [1.0, 2.0, 3.0]
    assert commands[1]["object"]["materials"][0]["color"] == 0xFF8000


def test_vertices_and_faces_travel_whole():
    window, sent = RecordingWindow(), part(2)
    draw(meshcat.Visualizer(window=window)["ball"], sent, (1.0, 1.0, 1.0, 0.5))
    (command,) = unpack(window.packed())
    data = command["object"]["geometries"][0]["data"]
    assert np.array_equal(
        np.frombuffer(data["attributes"]["position"]["array"].data, np.float32), sent.vertices.ravel()
    )
    assert np.array_equal(np.frombuffer(data["index"]["array"].data, np.uint16), sent.faces.ravel())
    assert command["object"]["materials"][0]["opacity"] == 0.5
    assert command["object"]["materials"][0]["transparent"] is True


def test_a_mesh_used_twice_is_stored_once():
    window = RecordingWindow()
    viewer = meshcat.Visualizer(window=window)
    draw(viewer["left"], part(4), (1.0, 0.0, 0.0, 1.0))
    once = len(window.packed())
    draw(viewer["right"], part(4), (0.0, 0.0, 1.0, 1.0))
    draw(viewer["other"], part(1), (0.0, 0.0, 1.0, 1.0))
    kinds = [c["object"]["geometries"][0]["type"] for c in unpack(window.packed())]
    assert kinds == ["BufferGeometry", "shared", "BufferGeometry"]
    assert len(window.packed()) < 1.1 * once + 1000


def test_the_same_scene_gives_the_same_bytes():
    packed = []
    for _ in range(2):
        window = RecordingWindow()
        draw(meshcat.Visualizer(window=window)["ball"], part(2), (1.0, 1.0, 1.0, 1.0))
        packed.append(window.packed())
    assert packed[0] == packed[1]
