"""Hostile problem files, SRDFs and meshes: good ones changed at random places, one a seed."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np

EXAMPLES = Path(__file__).parents[2] / "examples"
PROBLEMS = ("04_acrobot.toml", "05_ur5.toml", "11_five_link_walking.toml")
MESHES = ("stl", "obj", "dae", "ply", "glb")

VALUES = (
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1e308",
    "1e-320",
    "9" * 5000,
    "10000000",
    "true",
    '""',
    "[]",
    "{}",
    "[[[[1]]]]",
    "[nan, nan]",
    '[1, "a", {}]',
    "1979-05-27",
    '"none"',
    '"../../../../etc/passwd"',
    '"/dev/zero"',
    '"/proc/self/mem"',
    '"http://127.0.0.1:9/a.urdf"',
    '"\\u0000"',
    '"\\u202eevil"',
    "\"__import__('os').system('touch hit')\"",
    '"{0.__class__}"',
    '{ type = "os.system" }',
    '{ type = "Compiled", compiler = "/bin/false" }',
    '{ type = "Effort", weight = 1e300 }',
    '{ type = "CollisionFree", srdf = "/dev/zero" }',
    "{ between = [1, -1] }",
    "[" * 40 + "]" * 40,
    '"' + "y" * 5000 + '"',
)
"""What is put in the place of a value of TOML."""

SRDF = """<robot name="r"><group name="arm"><chain base_link="a" tip_link="b"/></group>
<disable_collisions link1="a" link2="b" reason="Adjacent"/><disable_collisions link1="b" link2="c" reason="Never"/>
<group_state name="home" group="arm"><joint name="j" value="0.1"/></group_state></robot>"""


def hostile_problem(seed: int) -> bytes:
    """Return a problem file with random changes of values, lines or bytes."""
    rng = np.random.default_rng([2023, seed])
    lines = (EXAMPLES / PROBLEMS[rng.integers(len(PROBLEMS))]).read_text(encoding="utf-8").splitlines()
    for _ in range(rng.integers(1, 4)):
        place = int(rng.integers(len(lines)))
        change = rng.integers(6)
        if change < 3:
            value = VALUES[rng.integers(len(VALUES))]
            pairs = [match.span(1) for match in re.finditer(r"= ([^,}=]+)", lines[place])]
            if pairs:
                start, end = pairs[rng.integers(len(pairs))]
                lines[place] = lines[place][:start] + value + lines[place][end:]
        elif change == 3:
            del lines[place]
            lines = lines or [""]
        elif change == 4:
            lines[place:place] = lines[: int(rng.integers(1, len(lines) + 1))]
        else:
            lines[place] = changed(lines[place].encode() or b"x", rng).decode("latin-1")
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def hostile_srdf(seed: int) -> bytes:
    """Return an SRDF with random changes of bytes."""
    return changed(SRDF.encode(), np.random.default_rng([2024, seed]))


def hostile_mesh(seed: int) -> tuple[str, bytes]:
    """Return the suffix and the bytes of a mesh with random changes."""
    rng = np.random.default_rng([2025, seed])
    suffix = MESHES[seed % len(MESHES)]
    return suffix, changed(good_mesh(suffix), rng)


@cache
def good_mesh(suffix: str) -> bytes:
    """Return a box in a format."""
    import trimesh

    found = trimesh.creation.box((0.1, 0.2, 0.3)).export(file_type=suffix)
    return found.encode() if isinstance(found, str) else bytes(found)


def changed(data: bytes, rng: np.random.Generator) -> bytes:
    """Return bytes with some replaced, removed, repeated or made large."""
    found = bytearray(data)
    for _ in range(rng.integers(1, 8)):
        place = int(rng.integers(len(found) or 1))
        change = rng.integers(5)
        if change == 0:
            found[place : place + 1] = bytes([rng.integers(256)])
        elif change == 1:
            del found[place : place + int(rng.integers(1, 50))]
        elif change == 2:
            found[place:place] = found[place : place + int(rng.integers(1, 300))]
        elif change == 3:
            found[place : place + 4] = b"\xff\xff\xff\x7f"
        else:
            found[place:place] = bytes(rng.integers(0, 256, rng.integers(1, 20), dtype=np.uint8))
    return bytes(found)
