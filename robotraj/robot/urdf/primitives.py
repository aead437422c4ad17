"""Boxes, spheres, cylinders and capsules of a URDF: whether their sizes are those of a shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element

from robotraj.robot.urdf.numbers import LARGEST, numbers

SIZES: Mapping[str, Sequence[tuple[str, int]]] = {
    "box": (("size", 3),),
    "sphere": (("radius", 1),),
    "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)),
}
"""Attributes that are sizes [m], and the number of their numbers."""


def impossible_size(shape: Element) -> str | None:
    """Return what is wrong with the sizes of a <visual> or <collision>; None for a mesh and for sizes of a shape."""
    for kind, keys in SIZES.items():
        for element in shape.findall(f"geometry/{kind}"):
            for key, count in keys:
                text = element.get(key, "")
                sizes = numbers(text, count)
                if sizes is None or not all(0.0 <= size <= LARGEST for size in sizes):
                    what = "numbers" if count > 1 else "number"
                    return f"{key}={text[:40]!r} of its {kind} is not {count} {what} from 0 to {LARGEST:g} m"
    return None
