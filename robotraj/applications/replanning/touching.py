"""A measured state, moved onto the contacts that hold in it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.guess.legs.stance import BalancedStance


def touching(stance: BalancedStance, q: Array, v: Array) -> tuple[Array, Array]:
    """Return the nearest configuration with the feet on the ground, and the velocity after their impact.

    Newton steps of least norm put the feet on the ground. The velocity solves

        v - M^-1 J' (J M^-1 J')^-1 J v,

    of least kinetic energy of the change: measured feet are never quite at rest.

    Parameters
    ----------
    stance : BalancedStance
        The contacts that hold; there may be none.
    q, v : ndarray (nq,), (nv,)
    """
    if not stance.contacts:
        return q, v
    q = stance.settle(q, stance.locate(q), stance.lifted({}))
    jacobian, model = stance.jacobian(q), stance.robot.model
    mass = pin.crba(model, stance.data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    spread = np.linalg.solve(mass, jacobian.T)
    impulse = np.linalg.lstsq(jacobian @ spread, jacobian @ v, rcond=1e-9)[0]
    return q, np.asarray(v - spread @ impulse)
