"""Weights of joints as users write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robotraj._util.errors import InputError, unknown_name


def weights_of(given: Any, joints: Sequence[str], who: str) -> list[float]:
    """One weight per joint from None (all 1), a number, a sequence, or a mapping (joints left out weigh 0).

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
        values = [given] if np.ndim(given) == 0 else list(np.ravel(given))
        values = values * len(joints) if len(values) == 1 else values
    if len(values) != len(joints):
        raise InputError(f"{who} has {len(values)} weights, but there are {len(joints)} to give: {', '.join(joints)}.")
    for joint, weight in zip(joints, values, strict=True):
        if not isinstance(weight, int | float | np.number) or not weight >= 0 or np.isinf(weight):
            raise InputError(f"{who}: the weight of {joint!r} is {weight!r}; it must be finite and not negative.")
    return [float(weight) for weight in values]
