"""A problem whose robots keep spheres around their links apart, where a plan without them overlaps itself."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from robotraj._util.errors import InputError
from robotraj.problem.constraints.collision_free import CollisionFree, disabled_pairs
from robotraj.problem.problem import Problem


def among_spheres(problem: Problem, overlaps: Sequence[Collection[int]]) -> Problem | None:
    """Return a problem with ``CollisionFree`` in the phases that have overlaps.

    Rows on the exact shapes bound distances near one motion alone; spheres bound them everywhere, but are larger than
    the links.

    Returns
    -------
    Problem or None
        None where these phases have one already, or where spheres overlap at an end.
    """
    phases = list(problem.phases)
    for number, pairs in enumerate(overlaps):
        own = phases[number].constraints
        if not pairs or any(isinstance(each, CollisionFree) and each.self_collision for each in own):
            continue
        free = CollisionFree(srdf=disabled_pairs(own))
        try:
            phases[number] = replace(phases[number], constraints=[*own, free])
        except InputError:
            return None
    is_same = all(own is given for own, given in zip(phases, problem.phases, strict=True))
    return None if is_same else Problem(phases, problem.links)
