"""The planning model whose followers move with their leaders, and back: a change of coordinates q_all = S q + s.

Followers are Pinocchio's mimic joints, which have no entries in q and v. The motor, damping, friction and armature of a
mechanism act at its leader: with multiplier m, those of a follower count m^2 times, its dry friction abs(m) times.
"""

from __future__ import annotations

from collections.abc import Sequence

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.loading.planning_model import names_of, parents_of, rebuilt


def coupled(model: pin.Model, mimics: Sequence[Mimic]) -> pin.Model:
    """Return a copy whose followers move with their leaders.

    Pinocchio needs a leader before its followers, so branches with followers are moved behind it.

    Parameters
    ----------
    model : pinocchio.Model
        Its joints are independent, with one position each.
    mimics : sequence of Mimic
        Couplings with independent leaders.

    Raises
    ------
    InputError
        A follower carries its leader, or two branches lead each other.
    """
    if not mimics:
        return model
    order = _leaders_first(model, mimics)
    copy = rebuilt(model, order=order)
    for mimic in mimics:
        leader, follower = (copy.joints[copy.getJointId(name)].idx_v for name in (mimic.leader, mimic.follower))
        for name in ("armature", "damping"):
            values = getattr(copy, name)
            values[leader] += mimic.multiplier**2 * values[follower]
        for values, sign in ((copy.upperDryFrictionLimit, 1.0), (copy.lowerDryFrictionLimit, -1.0)):
            values[leader] += sign * abs(mimic.multiplier * values[follower])
    for mimic in mimics:
        leader, follower = copy.getJointId(mimic.leader), copy.getJointId(mimic.follower)
        copy = pin.transformJointIntoMimic(copy, leader, follower, mimic.multiplier, mimic.offset)
    return copy


def uncoupled(model: pin.Model) -> pin.Model:
    """Return a model of the same joints in the same order, all of them independent.

    Armature and damping of a mechanism stay at its leader.
    """
    return rebuilt(model) if len(model.mimicking_joints) else model


def _leaders_first(model: pin.Model, mimics: Sequence[Mimic]) -> list[int]:
    """Return the joints in depth-first order, which Pinocchio needs, with leaders before followers."""
    names, parents = names_of(model), parents_of(model)
    children: dict[int, list[int]] = {}
    for joint in range(1, model.njoints):
        children.setdefault(parents[joint], []).append(joint)
    # At the joint where both part, the branch of a leader comes before that of its follower.
    earlier: dict[int, dict[int, Mimic]] = {}
    for mimic in mimics:
        first, second = (list(model.supports[names.index(name)]) for name in (mimic.leader, mimic.follower))
        shared = sum(a == b for a, b in zip(first, second, strict=False))
        if shared == len(second):
            raise _backwards(mimic)
        if shared < len(first):
            earlier.setdefault(second[shared], {})[first[shared]] = mimic
    order: list[int] = []
    waiting = [[0]]
    while waiting:
        branches = waiting[-1]
        if not branches:
            waiting.pop()
            continue
        ready = [b for b in branches if not earlier.get(b, {}).keys() & set(branches)]
        if not ready:
            raise _backwards(next(mimic for b in branches for mimic in earlier[b].values()))
        joint = ready[0]
        branches.remove(joint)
        order.append(joint)
        waiting.append(list(children.get(joint, [])))
    return order[1:]


def _backwards(mimic: Mimic) -> InputError:
    m, c = 1.0 / mimic.multiplier, -mimic.offset / mimic.multiplier
    return InputError(
        f"Joint {mimic.follower!r} mimics {mimic.leader!r}, which it carries, or which stands behind it for another "
        f'pair. Exchange them: give {mimic.leader!r} <mimic joint="{mimic.follower}" multiplier="{m:.9g}" '
        f'offset="{c:.9g}"/>, and take it from {mimic.follower!r}.'
    )
