"""Weights of joints in the forms that users may give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import short

WeightsLike: TypeAlias = float | Sequence[float] | NDArray[np.float64] | Mapping[str, float] | None
"""One weight for all joints, one for each, or some by name; None weighs all joints by 1."""


def weights_of(given: WeightsLike, joints: Sequence[str], what: str) -> list[float]:
    """Return one weight per joint from None (all 1), a number, a sequence, or a mapping (other joints weigh 0).

    Raises
    ------
    InputError
        A joint is unknown, the number of weights is wrong, or a weight is negative or not finite. ``what`` is the
        label of the objective in the message.
    """
    if given is None:
        return [1.0] * len(joints)
    if isinstance(given, Mapping):
        for key in given:
            if key not in joints:
                raise unknown_name("joint or variable", key, joints, f"{what} weighs these.")
        values = [given.get(joint, 0.0) for joint in joints]
    else:
        values = list(np.ravel(given))
        values = values * len(joints) if len(values) == 1 else values
    if len(values) != len(joints):
        raise InputError(f"{what} has {len(values)} weights, but there are {len(joints)} to give: {', '.join(joints)}.")
    for joint, weight in zip(joints, values, strict=True):
        if not is_finite(weight) or weight < 0:
            raise InputError(f"{what}: the weight of {joint!r} is {short(weight)}; it must be finite and not negative.")
    return [float(weight) for weight in values]
