"""Weights of joints as users write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError, unknown_name

WeightsLike: TypeAlias = float | Sequence[float] | NDArray[np.float64] | Mapping[str, float] | None
"""One weight for all joints, one for each, or some by name; None weighs all joints by 1."""


def weights_of(given: WeightsLike, joints: Sequence[str], who: str) -> list[float]:
    """Return one weight per joint from None (all 1), a number, a sequence, or a mapping (other joints weigh 0).

    Raises
    ------
    InputError
        An unknown joint, a wrong number of weights, a negative or infinite one; ``who`` names the objective.
    """
    if given is None:
        return [1.0] * len(joints)
    if isinstance(given, Mapping):
        for key in given:
            if key not in joints:
                raise unknown_name("joint or variable", key, joints, f"{who} weighs these.")
        values = [given.get(joint, 0.0) for joint in joints]
    else:
        values = list(np.ravel(given))
        values = values * len(joints) if len(values) == 1 else values
    if len(values) != len(joints):
        raise InputError(f"{who} has {len(values)} weights, but there are {len(joints)} to give: {', '.join(joints)}.")
    for joint, weight in zip(joints, values, strict=True):
        if not isinstance(weight, int | float | np.number) or not weight >= 0 or np.isinf(weight):
            raise InputError(f"{who}: the weight of {joint!r} is {weight!r}; it must be finite and not negative.")
    return [float(weight) for weight in values]
