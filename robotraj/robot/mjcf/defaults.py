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

ENABLED = {"range": "limited", "actuatorfrcrange": "actuatorfrclimited"}
ENABLED |= {"forcerange": "forcelimited", "ctrlrange": "ctrllimited"}
"""Ranges, and the attributes that enable them; a range that is disabled is no limit."""

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


def placed(root: Element, tag: str) -> Iterator[Attributes]:
    """Yield the attributes of every joint or geom of the bodies, with those of its class."""
    defaults = Defaults(root)
    for world in root.findall("worldbody"):
        yield from (defaults.of(element, inherited) for element, inherited in _below(world) if element.tag == tag)


def with_defaults(root: Element) -> None:
    """Give elements the attributes of their classes, and remove the classes and the ranges that are disabled.

    Pinocchio's reader leaves some of them out, such as the place of a joint and the mass of a shape.
    """
    defaults = Defaults(root)
    every = [pair for world in root.findall("worldbody") for pair in _below(world)]
    every += [(each, MAIN) for group in root if group.tag in ("asset", "actuator") for each in group]
    for element, inherited in every:
        element.attrib.update(defaults.of(element, inherited))
        if "jointinparent" in element.attrib:  # the same for joints with one degree of freedom
            element.attrib.setdefault("joint", element.attrib["jointinparent"])
        for limit, enabling in ENABLED.items():
            if element.get(enabling) == "false":
                element.attrib.pop(limit, None)
        if element.tag == "joint" and "ref" in element.attrib and "range" in element.attrib:
            # Pinocchio's reader subtracts the reference from the range, which is one of positions.
            ends = (float(end) + float(element.attrib["ref"].split()[0]) for end in element.attrib["range"].split())
            element.set("range", " ".join(map(repr, ends)))
    for element in root.iter():
        for name in ("class", "childclass"):
            element.attrib.pop(name, None)
    for top in root.findall("default"):
        root.remove(top)


def _below(holder: Element, inherited: str = MAIN) -> Iterator[tuple[Element, str]]:
    """Yield what bodies hold, and the class of the nearest body around it."""
    inherited = holder.get("childclass", inherited)
    for child in holder:
        if child.tag in ("body", "frame"):
            yield from _below(child, inherited)
        else:
            yield child, inherited


def _kind(tag: str) -> str:
    return "actuator" if tag in ACTUATORS else tag
