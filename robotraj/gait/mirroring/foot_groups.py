"""Groups of feet that swing together in the steps of a walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot
from robotraj.robot.sides.images import frames_across, places_of

FEWEST = 6
"""Number of feet from which on alternate feet of both sides swing together by default."""
Groups = tuple[tuple[str, ...], ...]


def foot_groups(robot: Robot, feet: Sequence[str], given: Sequence[Sequence[str]] | None) -> Groups:
    """Return the groups of feet in the order in which they swing.

    By default they are the second and the first foot of a biped. From six feet on they are the alternate ones, counted
    from the front with the sides reversed: of a hexapod the middle left, front right and hind right feet, then the
    others. There are none for other numbers of feet.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        All feet; the first one stands first by default.
    given : sequence of sequences of str, optional

    Raises
    ------
    InputError
        The given groups do not hold each foot once, or there is only one group.
    """
    if given is not None:
        groups = tuple((group,) if isinstance(group, str) else tuple(group) for group in given)
        every = [foot for group in groups for foot in group]
        if len(groups) < 2 or not all(groups) or sorted(every) != sorted(feet):
            raise InputError(
                f"groups= is {[list(group) for group in groups]!r}; name each of the feet {', '.join(feet)} in one "
                "group of those that swing together, two groups or more."
            )
        return groups
    if len(feet) == 2:
        return ((feet[1],), (feet[0],))
    across, places = frames_across(robot, feet), places_of(robot, robot.neutral)
    left, right = (sorted((f for f in feet if s * places[f][1] > 0.0), key=lambda f: -places[f][0]) for s in (1, -1))
    paired = all(across[foot] != foot for foot in feet) and len(left) == len(right)
    if len(feet) < FEWEST or not paired:
        return ()
    first = (*left[::2], *right[1::2])
    second = tuple(foot for foot in feet if foot not in first)
    return (second, first) if feet[0] in first else (first, second)


def halves(groups: Groups, across: Mapping[str, str]) -> bool:
    """Whether the second half of the groups is the first half on the other side."""
    half, odd = divmod(len(groups), 2)
    return not odd and all(
        {across[foot] for foot in one} == set(other) for one, other in zip(groups[:half], groups[half:], strict=True)
    )
