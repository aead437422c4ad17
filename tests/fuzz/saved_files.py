"""Hostile saved files: good ones of every kind of plan, changed at random places, one a seed."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

import robotraj as rt

VALUES: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    -1,
    1,
    2,
    7,
    10**6,
    10**9,
    10**18,
    -(10**18),
    1e-320,
    1e308,
    0.5,
    -0.0,
    "",
    "a",
    "\x00",
    "__class__",
    "../../etc/passwd",
    "/dev/stdin",
    "x" * 100_000,
    "\ud7ff\u202e",
    [],
    {},
    [[]],
    [0] * 3,
    {"$list": []},
    {"$tuple": [1, "a"]},
    {"$float": "nan"},
    {"$float": "inf"},
    {"$float": "x"},
    {"$path": "/proc/self/mem"},
    {"$path": "/dev/zero"},
    {"$array": "about"},
    {"$array": "nowhere"},
    {"$enum": "Status", "member": "SOLVED"},
    {"$class": "Path", "fields": {}},
    {"$class": "os.system", "fields": {"command": "touch hit"}},
    {"$class": "robotraj.native.engines.cache.Cache", "fields": {"folder": {"$path": "hit"}}},
    {"$class": "State", "fields": {}},
    {"$class": "Mesh", "fields": {"intervals": 100_000}},
    {"$class": "HeightMap", "fields": {}},
    {"$class": "UrdfGeometry", "fields": {"urdf": {"$path": "/dev/zero"}, "folders": {"$tuple": []}}},
    {"$class": "Compiled", "fields": {"compiler": "touch hit"}},
    {"$class": "Robot", "fields": {}},
    {"$model": {}},
)
"""What is put in the place of a value."""


def good_files(folder: Path, solver: rt.InteriorPoint | None = None) -> list[Path]:
    """Save plans of a robot with a proof and gains, a System, an arm among obstacles, and a leg with contacts."""
    block = rt.System(
        states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]], name="block"
    )
    ends = rt.State({"x": 0, "v": 0}), rt.State({"x": 1, "v": 0})
    pendulum, arm, hopper = rt.load("pendulum"), rt.load("two_link_arm"), rt.load("monopod")
    box = rt.obstacles.Box((0.1, 0.1, 0.1), position=(3.0, 0.0, 0.0))
    foot = next(name for name in hopper.frame_names if "foot" in name)
    stand = rt.Phase(
        hopper,
        0.3,
        objective=rt.Effort(),
        contacts=[rt.PointContact(foot, friction=0.7)],
        name="stand",
    )
    plans = {
        "proved": rt.plan(rt.Phase(pendulum, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()), solver=solver),
        "system": rt.plan(
            rt.Phase(block, 1.0, *ends, rt.Lagrange(lambda point: point.u["u"] ** 2)),
            mesh=rt.Mesh(4),
            solver=solver,
            check=False,
        ),
        "obstacles": rt.plan(
            rt.Phase(
                arm,
                (0.5, 3.0),
                rt.State(q=0, v=0),
                rt.State(q=0.3, v=0),
                rt.Effort() + rt.Duration(),
                constraints=[rt.CollisionFree([box])],
            ),
            mesh=rt.Mesh(4),
            solver=solver,
            check=False,
        ),
        "contacts": rt.plan(stand, mesh=rt.Mesh(3), check=False, solver=solver or rt.InteriorPoint(max_iterations=5)),
    }
    _ = plans["proved"].gains
    return [solution.save(folder / f"{name}.npz") for name, solution in plans.items()]


def hostile_file(seed: int, good: list[Path]) -> bytes:
    """Return a good file with random changes."""
    rng = np.random.default_rng([22, seed])
    source = good[rng.integers(len(good))].read_bytes()
    kind = rng.choice(["bytes", "entries", "headers", "json", "json", "json", "json", "arrays", "arrays", "splice"])
    if kind == "bytes":
        return _raw(source, rng)
    entries = _entries(source)
    if kind == "entries":
        _change_entries(entries, rng)
    elif kind == "headers":
        name = str(rng.choice(list(entries)))
        data = bytearray(entries[name])
        for place in rng.integers(0, min(128, len(data)), rng.integers(1, 4)):
            data[place] = rng.integers(0, 256)
        entries[name] = bytes(data)
    elif kind == "json":
        text = json.loads(str(np.load(io.BytesIO(entries["solution.npy"]))))
        for _ in range(rng.integers(1, 4)):
            _change_json(text, rng)
        entries["solution.npy"] = _npy(np.array(json.dumps(text)))
    elif kind == "arrays":
        for _ in range(rng.integers(1, 3)):
            name = str(rng.choice([name for name in entries if name not in ("about.npy", "solution.npy")]))
            entries[name] = _npy(_changed_array(np.load(io.BytesIO(entries[name])), rng))
    else:
        other = _entries(good[rng.integers(len(good))].read_bytes())
        for name in rng.choice(list(other), rng.integers(1, 5)):
            entries[str(name)] = other[str(name)]
    return _packed(entries)


def _raw(source: bytes, rng: np.random.Generator) -> bytes:
    data = bytearray(source)
    for _ in range(rng.integers(1, 6)):
        place, length = int(rng.integers(0, len(data))), int(rng.integers(1, 64))
        change = rng.integers(4)
        if change == 0:
            data[place] ^= 1 << rng.integers(0, 8)
        elif change == 1:
            del data[place : place + length]
        elif change == 2:
            data[place:place] = rng.bytes(length)
        else:
            # The end holds the directory of the archive: sizes, offsets, names.
            tail = max(0, len(data) - 200 + int(rng.integers(0, 199)))
            data[tail] = rng.integers(0, 256)
    return bytes(data)


def _change_entries(entries: dict[str, bytes], rng: np.random.Generator) -> None:
    name = str(rng.choice(list(entries)))
    change = rng.integers(6)
    if change == 0:
        del entries[name]
    elif change == 1:
        entries["../" + name] = entries.pop(name)
    elif change == 2:
        entries[name] = entries[name][: rng.integers(0, len(entries[name]))]
    elif change == 3:
        entries[name] = rng.bytes(200)
    elif change == 4:
        entries[name] = b"\x80\x04\x95cos\nsystem\n(S'touch hit'\ntR."
    else:
        entries[name] = _npy(np.array(["touch hit"] * 3, dtype=object), pickled=True)


def _places(value: Any, depth: int = 0) -> list[tuple[Any, Any]]:
    """Every (container, key) of a JSON value."""
    keys = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    return [place for key in keys for place in ((value, key), *_places(value[key], depth + 1))]


def _change_json(text: Any, rng: np.random.Generator) -> None:
    places = _places(text)
    if not places:
        return
    container, key = places[rng.integers(len(places))]
    change = rng.integers(8)
    if change < 4:
        container[key] = json.loads(json.dumps(VALUES[rng.integers(len(VALUES))]))
    elif change == 4:
        del container[key]
    elif change == 5:
        other, at = places[rng.integers(len(places))]
        container[key] = json.loads(json.dumps(other[at]))
    elif change == 6 and isinstance(container[key], int | float):
        container[key] = container[key] * int(rng.choice([-1, 10, 1000, 10**6])) + int(rng.integers(-1, 2))
    elif isinstance(container, dict):
        container["extra" if change == 6 else "$class"] = VALUES[rng.integers(len(VALUES))]
    else:
        container.extend([container[key]] * 1000)


def _changed_array(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    change, flat = rng.integers(9), array.ravel().copy()
    if change < 3 and flat.size and array.dtype.kind == "f":
        flat[rng.integers(flat.size)] = rng.choice([np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0, -1.0])
        return flat.reshape(array.shape)
    if change == 3:
        return array[..., :-1] if array.ndim else np.zeros(3)
    if change == 4:
        return np.zeros((0,) * max(1, array.ndim))
    if change == 5:
        return array.astype("U16")
    if change == 6 and array.dtype.kind in "fiu":
        return (array * rng.choice([-1.0, 0.0, 1e300, 1e-300])).astype(array.dtype)
    if change == 7:
        return np.zeros((2,) * 20, dtype="i1")
    return array.T[None] if array.ndim else np.array([array])


def _entries(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _packed(entries: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return buffer.getvalue()


def _npy(array: np.ndarray, pickled: bool = False) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=pickled)
    return buffer.getvalue()
