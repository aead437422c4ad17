"""Groups of curves: the root, each leg or chain with the contacts it carries, or the variables of a system."""

from __future__ import annotations

import re
from collections.abc import Sequence

import pinocchio as pin

from robotraj.replay_page.footholds import contact_frames, contact_names
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of
from robotraj.solution.cycles.gait_cycles import GaitCycles

Group = dict[str, object]
"""``name``, ``root`` (whether it is the root's) and ``labels`` of its curves."""


def groups_of(robot: Robot | None, cycles: GaitCycles, labels: Sequence[str]) -> list[Group]:
    """Return the groups of a page's curves; those of no joint, such as distances, are in none and always shown.

    A chain of joints ends where the tree branches. A contact belongs to the chain that carries its frame.

    Parameters
    ----------
    robot : Robot or None
        None for a system, whose variables are one group.
    cycles : GaitCycles
    labels : sequence of str
        Labels of all curves.
    """
    if robot is None:
        return [{"name": "variables", "root": False, "labels": list(labels)}]
    root = root_of(robot.root)
    own = [label for label in labels if label in (*root.positions, *root.velocities)]
    chains = chains_of(robot.model, set(root.joints))
    members: list[list[str]] = [[] for _ in chains]
    frames = contact_frames(cycles)
    carried = {name: robot.model.frames[robot.frame(frame)].parentJoint for name, frame in frames.items()}
    place = {joint: k for k, chain in enumerate(chains) for joint in chain}
    contacts = set(contact_names(cycles))
    for label in labels:
        joint = carried.get(label) if label in contacts else _joint(robot.model, label)
        if label in own:
            continue
        if joint in place:
            members[place[joint]].append(label)
    names = _names([[str(robot.model.names[joint]) for joint in chain] for chain in chains])
    found: list[Group] = [{"name": n, "root": False, "labels": m} for n, m in zip(names, members, strict=True) if m]
    if own:
        found.append({"name": "root", "root": True, "labels": own})
    return found


def chains_of(model: pin.Model, root: set[str]) -> list[list[int]]:
    """Return the joints of each unbranched chain, parents first; joints of the root are left out."""
    moved = [joint for joint in range(1, model.njoints) if model.names[joint] not in root]
    children: dict[int, list[int]] = {}
    for joint in moved:
        children.setdefault(int(model.parents[joint]), []).append(joint)
    chains: list[list[int]] = []
    for joint in moved:
        parent = int(model.parents[joint])
        last = next((chain for chain in chains if chain[-1] == parent), None)
        if last is not None and len(children[parent]) == 1:
            last.append(joint)
        else:
            chains.append([joint])
    return chains


def _joint(model: pin.Model, label: str) -> int | None:
    """Return the joint of a curve; those of a joint with several coordinates begin with its name."""
    names = [str(name) for name in model.names]
    if label in names:
        return names.index(label)
    starts = [k for k, name in enumerate(names) if k > 0 and label.startswith(name)]
    return max(starts, key=lambda k: len(names[k]), default=None)


def _names(chains: list[list[str]]) -> list[str]:
    """Name each chain by the words that most of its joints share; by its first joint where that is not unique."""
    if len(chains) == 1:
        return ["joints"]
    words = [[_words(joint) for joint in joints] for joints in chains]
    names = [
        " ".join(word for word in own[0] if 2 * sum(word in other for other in own) > len(own) and not word.isdigit())
        for own in words
    ]
    for longer in ([" ".join(own[0][:2]) for own in words], [joints[0] for joints in chains]):
        names = [name if name and names.count(name) == 1 else longer[k] for k, name in enumerate(names)]
    return names


def _words(joint: str) -> list[str]:
    return [word for word in re.split(r"[_\s]+", joint) if word.lower() != "joint"]
