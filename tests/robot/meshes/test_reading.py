"""Meshes of strangers are read or refused with a reason, within seconds and a gigabyte; no other file is opened."""

from __future__ import annotations

import os
import re
import signal
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import trimesh

import robotraj as rt
from robotraj._util.system.limited import LimitedProcess
from robotraj.robot.meshes.arrays import MeshArrays
from robotraj.robot.meshes.reading import read_mesh_file, read_meshes

CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
INSTANCE = "<instance_geometry url='#g'/>"


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def stl(corners: np.ndarray = CORNERS, faces: np.ndarray = FACES, count: int | None = None) -> bytes:
    head = b"\0" * 80 + struct.pack("<I", len(faces) if count is None else count)
    return head + b"".join(struct.pack("<12fH", 0, 0, 0, *corners[face].ravel(), 0) for face in faces)


def dae(nodes: str = f"<node>{INSTANCE}</node>", head: str = "", positions: str = "", count: int = 12) -> bytes:
    numbers = positions or " ".join(map(str, CORNERS.ravel()))
    return f"""<?xml version="1.0"?>{head}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="{count}">{numbers}</float_array>
<technique_common><accessor source="#a" count="{count // 3}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>{" ".join(map(str, FACES.ravel()))}</p>
</triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


BOMB = "".join(f"<node id='n{k}'>" + f"<instance_node url='#n{k + 1}'/>" * 10 + "</node>" for k in range(7, -1, -1))
BOMB = f"<node id='n8'>{INSTANCE}</node>{BOMB}"
AREA = 0.015 + 0.005 * np.sqrt(3.0)
NAN = " ".join(["nan"] * 12)
BILLION = (
    "<!DOCTYPE c [<!ENTITY a 'xxxxxxxxxx'>"
    + "".join(f"<!ENTITY {b} '{f'&{a};' * 10}'>" for a, b in zip("abcdefgh", "bcdefghi", strict=True))
    + "]>"
)

READ = {
    "good.stl": stl(),
    "good.obj": OBJ.encode(),
    "good.dae": dae(),
    "pipe.obj": b"mtllib pipe.mtl\nusemtl a\n" + OBJ.encode(),
    "zero.obj": b"mtllib /dev/zero\nmtl\\\nlib pipe.mtl\n" + OBJ.encode(),
    "solid.stl": b"solid " + stl()[6:],
    "mirrored.dae": dae(f"<node><scale>-1 1 1</scale>{INSTANCE}</node>"),
}
REFUSED = {
    "announced.stl": (stl(count=0xFFFFFFFF), "announces 4294967295 triangles"),
    "few.stl": (stl(count=60_000_000), "announces 60000000 triangles"),
    "nan.stl": (stl(CORNERS * np.nan), ""),
    "far.stl": (stl(CORNERS * 1e12), "coordinate above"),
    "none.stl": (stl(faces=FACES[:0]), ""),
    "empty.stl": (b"", ""),
    "text.stl": (b"hello", ""),
    "wide.obj": (OBJ.encode("utf-16"), "No meshes found in it"),
    "corner.obj": (OBJ.encode() + b"f 1 2 4294967295\n", ""),
    "commands.obj": (b"call /etc/passwd\ncsh touch hit\n", ""),
    "itself.dae": (dae(f"<node id='n'>{INSTANCE}<instance_node url='#n'/></node>"), ""),
    "bomb.dae": (dae(BOMB), "takes more than"),
    "entities.dae": (dae(head=BILLION, positions="&i;"), ""),
    "nan.dae": (dae(positions=NAN), "no number"),
    "point.stl": (stl(0.0 * CORNERS), ""),
    "short.dae": (dae()[:700], ""),
    "header.glb": (b"glTF" + struct.pack("<IIII", 2, 20, 0xFFFFFFF0, 0x4E4F534A), ""),
    "fields.glb": (
        b"glTF" + struct.pack("<IIII", 2, 52, 32, 0x4E4F534A) + b'{"meshes":[{"primitives":1}]}   ',
        "damaged",
    ),
    "encoding.glb": (
        b"glTF" + struct.pack("<IIII", 2, 48, 28, 0x4E4F534A) + b'{"asset":{"version":"\xff\xfe"}} ',
        "not UTF-8",
    ),
    "vertices.ply": (b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n0\n", ""),
    "other.gltf": (b"{}", "format .gltf is none of"),
    "other.blend": (b"BLENDER_v277", "format .blend is none of"),
}


class Used(NamedTuple):
    """Processor time [s] and peak memory [kB] of a process."""

    seconds: float
    memory: int


@pytest.fixture
def children(monkeypatch: pytest.MonkeyPatch) -> list[Used]:
    """What each reading process used. The system's own peak of a child begins with that of its parent."""
    used: list[Used] = []
    end = LimitedProcess._end

    def measured(process: LimitedProcess) -> int:
        if (running := process._running) is not None:
            # A process that has ended has no line of its peak; its limit has bounded it.
            known = re.search(r"VmHWM:\s*(\d+) kB", Path(f"/proc/{running.pid}/status").read_text())
            os.kill(running.pid, signal.SIGKILL)
            _, status, usage = os.wait4(running.pid, 0)
            running.returncode = os.waitstatus_to_exitcode(status)
            used.append(Used(usage.ru_utime + usage.ru_stime, int(known[1]) if known else 0))
        return end(process)

    monkeypatch.setattr(LimitedProcess, "_end", measured)
    return used


@pytest.fixture
def budget(children: list[Used]) -> Iterator[None]:
    """At most 5 s of processor time and 1 GB, the reading process included."""
    began = time.process_time()
    yield
    assert time.process_time() - began + sum(each.seconds for each in children) < 5.0
    assert max((each.memory for each in children), default=0) < 1e6  # [kB]


@pytest.mark.usefixtures("budget")
@pytest.mark.parametrize("name", READ)
def test_a_sound_mesh_is_read(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.mtl")
    (tmp_path / name).write_bytes(READ[name])
    found = read_mesh_file(tmp_path / name)
    assert trimesh.Trimesh(found.vertices, found.triangles).area == pytest.approx(
        0.015 + 0.005 * np.sqrt(3.0), rel=1e-6
    )


@pytest.mark.usefixtures("budget")
def test_triangles_that_lie_on_others_are_left_out_of_large_meshes(tmp_path: Path) -> None:
    turned = np.concatenate([np.roll(FACES, k, axis=1) for k in range(3)] + [FACES[:, ::-1]])
    for name, data in (
        ("many.stl", stl(faces=np.tile(turned, (5_000, 1)))),
        ("many.obj", OBJ.encode() + b"".join(b"g a%d\nf 1 2 3\n" % k for k in range(60_000))),
    ):
        (tmp_path / name).write_bytes(data)
        found = read_mesh_file(tmp_path / name)
        assert len(found.triangles) == 4 and len(found.vertices) == 4
        assert trimesh.Trimesh(found.vertices, found.triangles).area == pytest.approx(AREA, rel=1e-6)


@pytest.mark.usefixtures("budget")
@pytest.mark.parametrize("name", REFUSED)
def test_a_hostile_mesh_is_refused_with_a_reason(name: str, tmp_path: Path) -> None:
    data, reason = REFUSED[name]
    (tmp_path / name).write_bytes(data)
    found = read_meshes([tmp_path / name])[tmp_path / name]
    assert isinstance(found, str) and reason in found


@pytest.mark.slow
@pytest.mark.parametrize("name", ["good.stl", "good.obj", "good.dae"])
def test_damaged_meshes_are_read_or_refused(name: str, tmp_path: Path, children: list[Used]) -> None:
    rng = np.random.default_rng(17)
    paths = []
    for number in range(60):
        data = bytearray(READ[name])
        for _ in range(rng.integers(1, 12)):
            i, change = rng.integers(len(data)), rng.integers(3)
            if change == 0:
                data[i] = rng.integers(256)
            elif change == 1:
                del data[i : i + rng.integers(1, 40)]
            else:
                data[i:i] = bytes(rng.integers(0, 256, rng.integers(1, 20), dtype=np.uint8))
        paths.append(tmp_path / f"{number}{Path(name).suffix}")
        paths[-1].write_bytes(bytes(data))
    found = read_meshes(paths)
    assert all(isinstance(each, MeshArrays) or each for each in found.values()) and len(found) == 60
    assert 0 < max(each.memory for each in children) < 1e6  # [kB]


def test_a_crash_of_the_reader_is_a_reason_and_the_next_mesh_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bad.dae").write_bytes(dae(BOMB))
    (tmp_path / "good.obj").write_text(OBJ)
    found = read_meshes([tmp_path / "bad.dae", tmp_path / "good.obj"])
    assert isinstance(found[tmp_path / "bad.dae"], str) and isinstance(found[tmp_path / "good.obj"], MeshArrays)
    monkeypatch.setattr(LimitedProcess, "ask", lambda *_: pytest.fail("asked again"))
    assert read_meshes(list(found)).keys() == found.keys()


@pytest.mark.parametrize("name", ["pipe.stl", "folder.stl", "missing.stl"])
def test_what_is_no_regular_file_is_not_opened(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(rt.InputError, match=name):
        read_mesh_file(tmp_path / name)


def test_a_damaged_entry_of_the_cache_is_read_again(tmp_path: Path) -> None:
    (tmp_path / "good.obj").write_text(OBJ)
    first = read_mesh_file(tmp_path / "good.obj")
    [kept] = (tmp_path / "cache").rglob("*.npz")
    kept.write_bytes(kept.read_bytes()[:-40])
    again = read_mesh_file(tmp_path / "good.obj")
    np.testing.assert_array_equal(again.vertices, first.vertices)


def test_meshes_of_nested_nodes_keep_their_corners(tmp_path: Path) -> None:
    """Bodies in a tree of nodes have the surface of the bodies; coal's own loader mixes up their corners."""
    nested = (
        f"<node>{INSTANCE}{INSTANCE}<node><translate>1 0 0</translate>{INSTANCE}<node>{INSTANCE}</node></node></node>"
    )
    (tmp_path / "tree.dae").write_bytes(dae(nested))
    found = read_mesh_file(tmp_path / "tree.dae")
    assert trimesh.Trimesh(found.vertices, found.triangles, process=False).area == pytest.approx(4 * AREA, rel=1e-6)
