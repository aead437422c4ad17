"""Kelly's cart-pole swing-up, which tests of several rooms plan."""

from __future__ import annotations

from typing import Any

import numpy as np

import robotraj as rt


def swing_up(**changes: Any) -> rt.Phase:
    """Least effort in 2 s and 1 m, with other arguments of ``rt.Phase`` where they are given."""
    known: dict[str, Any] = {
        "duration": 2.0,
        "start": rt.State(q=[0, 0], v=0),
        "end": rt.State(q=[1, np.pi], v=0),
        "objective": rt.Effort(),
        "name": "swing-up",
    }
    return rt.Phase(rt.load("cartpole"), **(known | changes))
