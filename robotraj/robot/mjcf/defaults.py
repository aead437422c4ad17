"""Attributes of elements of an MJCF file, with those of their default classes.

Source: the chapters *Default settings* and *childclass* of MuJoCo's documentation of its XML format.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element

ACTUATORS = (
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
)
"""Elements that set one kind of default: MuJoCo has general actuators only, and the others are short forms of it."""
MAIN = "main"
"""Class of the elements that name none."""

Attributes = Mapping[str, str]


class Defaults:
    """The default classes of a file."""

    def __init__(self, root: Element) -> None:
        self._classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
        for top in root.findall("default"):
            self._read(top, MAIN, {})

    def of(self, element: Element, inherited: str = MAIN) -> Attributes:
        """Return the attributes of an element: its own, then those of its class.

        Parameters
        ----------
        element : Element
        inherited : str
            Class of the nearest body around it with a ``childclass``; the element's own ``class`` precedes it.
        """
        name = element.get("class", inherited)
        return {**self._classes.get(name, self._classes[MAIN]).get(_kind(element.tag), {}), **element.attrib}

    def _read(self, element: Element, name: str, above: Mapping[str, dict[str, str]]) -> None:
        """Read a class, which starts from the one around it, and the classes in it."""
        own = {kind: dict(values) for kind, values in above.items()}
        for child in element:
            if child.tag != "default":
                own.setdefault(_kind(child.tag), {}).update(child.attrib)
        self._classes.setdefault(name, {}).update(own)
        if "class" in element.attrib:
            self._classes[element.attrib["class"]] = own
        for child in element.findall("default"):
            self._read(child, child.get("class", MAIN), own)


def placed(root: Element, defaults: Defaults, tag: str) -> Iterator[Attributes]:
    """Yield the attributes of every joint or geom of the bodies, with those of its class."""

    def below(body: Element, inherited: str) -> Iterator[Attributes]:
        inherited = body.get("childclass", inherited)
        for child in body:
            if child.tag == tag:
                yield defaults.of(child, inherited)
            elif child.tag in ("body", "frame"):
                yield from below(child, inherited)

    for world in root.findall("worldbody"):
        yield from below(world, MAIN)


def _kind(tag: str) -> str:
    return "actuator" if tag in ACTUATORS else tag
