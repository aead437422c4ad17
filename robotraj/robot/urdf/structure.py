"""Checks of a URDF's tree: its size, unique names, one parent per link, one root, no cycle.

The checks run before Pinocchio reads the file. Its parser recurses once per link of a chain and overflows the stack
after a few thousand links. Its time grows with the square of the number of links.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError, unknown_name

MAX_LINKS = 5_000
"""Largest number of links; Pinocchio reads so many in about a second."""
MAX_DEPTH = 1_000
"""Largest number of joints between the root link and a leaf."""
SHOWN = 10
"""Largest number of names or faults that a message lists."""


def check_structure(file: str, root: Element) -> None:
    """Check that links and joints form one tree of a size that can be read.

    Parameters
    ----------
    file : str
        The file's name for messages.
    root : Element
        The ``<robot>`` element.

    Raises
    ------
    InputError
        There is no link, or more than ``MAX_LINKS``, or ``MAX_DEPTH`` joints in a chain. Or names are missing, unknown
        or duplicate, a link has two parents, or the tree has several roots or a cycle.
    """
    links = [link.get("name", "") for link in root.findall("link")]
    joints = root.findall("joint")
    if not links:
        raise InputError(f"{file}: no <link> stands below <robot>; a URDF has one or more.")
    if len(links) > MAX_LINKS:
        raise InputError(
            f"{file}: {len(links)} links; at most {MAX_LINKS} can be read. Merge links joined by fixed joints."
        )
    for kind, names in (("link", links), ("joint", [joint.get("name", "") for joint in joints])):
        if not all(names):
            raise InputError(f"{file}: a {kind} has no name; give every <{kind}> a name=.")
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise InputError(
                f"{file}: several {kind}s have the name {listed(twice)}; give each {kind} a name of its own."
            )
    known = set(links)
    parents: dict[str, str] = {}
    children: dict[str, list[str]] = {}
    mover: dict[str, str] = {}
    for joint in joints:
        name = joint.get("name", "")
        parent, child = (_end(file, joint, end, links, known) for end in ("parent", "child"))
        if child in parents:
            raise InputError(
                f"{file}: link {child!r} is the child of joints {mover[child]!r} and {name!r}; a URDF is a tree. "
                "Remove one joint, and close the loop with rt.contacts.LoopClosure."
            )
        parents[child], mover[child] = parent, name
        children.setdefault(parent, []).append(child)
    _check_tree(file, links, parents, children)


def listed(names: Iterable[str]) -> str:
    """Return quoted names, at most ``SHOWN`` of them."""
    every = list(names)
    more = f", ... ({len(every)} in all)" if len(every) > SHOWN else ""
    return ", ".join(map(repr, every[:SHOWN])) + more


def _end(file: str, joint: Element, end: str, links: list[str], known: set[str]) -> str:
    """Return the link at one end of a joint."""
    tag = joint.find(end)
    link = None if tag is None else tag.get("link")
    if link is None or link not in known:
        raise unknown_name("link", link, links, f"It is the {end} of joint {joint.get('name')!r} in {file}.")
    return link


def _check_tree(file: str, links: list[str], parents: dict[str, str], children: dict[str, list[str]]) -> None:
    """Check that every link is reached from one root, within ``MAX_DEPTH`` joints."""
    roots = [link for link in links if link not in parents]
    if len(roots) > 1:
        raise InputError(
            f"{file}: the links {listed(roots)} are no joint's child; a URDF has one such root. "
            "Join the others to it by fixed joints."
        )
    reached, level, depth = set(roots), roots, 0
    while level:
        level = [child for link in level for child in children.get(link, ())]
        reached.update(level)
        depth += bool(level)
    circle = [link for link in links if link not in reached]
    if circle:
        raise InputError(
            f"{file}: the joints of the links {listed(circle)} form a cycle; a URDF is a tree. Remove one joint."
        )
    if depth > MAX_DEPTH:
        raise InputError(
            f"{file}: {depth} joints follow one another; chains of at most {MAX_DEPTH} can be read. Merge "
            "links joined by fixed joints."
        )
