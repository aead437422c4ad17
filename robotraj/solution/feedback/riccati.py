"""Finite-horizon linear-quadratic feedback, by a recursion that neither overflows nor loses positivity.

The cost to go e' S' S e is represented by its square root S and propagated backwards by QR factorisations. Torques are
scaled by their cost. Transition matrices are L-stable Padé approximations (1, 2) of the exponential, so that fast
decay, such as by friction on light wrists, does not require short pieces.
Source: Anderson and Moore, Optimal Control: Linear Quadratic Methods (1990); Hairer and Wanner, Solving Ordinary
Differential Equations II (1996), section IV.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array


def transition(rate: Array, push: Array, duration: float) -> tuple[Array, Array]:
    """Matrices of e(t + h) = F e(t) + G u for e' = A e + B u over a short time h, u constant.

    F = (I - 2/3 hA + 1/6 (hA)^2)^-1 (I + 1/3 hA), of order 3.
    """
    scaled = duration * rate
    size = len(rate)
    denominator = np.eye(size) - (2.0 / 3.0) * scaled + scaled @ scaled / 6.0
    inputs = duration * (push - scaled @ push / 6.0)
    both = np.asarray(np.linalg.solve(denominator, np.hstack([np.eye(size) + scaled / 3.0, inputs])), dtype=float)
    return both[:, :size], both[:, size:]


def backwards(
    root: Array, pieces: Sequence[tuple[Array, Array]], weights: Sequence[tuple[Array, Array]]
) -> tuple[Array, list[Array]]:
    """Gains K of u = -K e along pieces of a motion, from the cost at its end back to its start.

    Parameters
    ----------
    root : ndarray (r, n)
        S at the end.
    pieces : sequence of (F, G)
        Transition matrices (n, n) and (n, m).
    weights : sequence of (ndarray (n,), ndarray (p, m))
        Roots of the cost of a piece: |q * e|^2 + |T u|^2.

    Returns
    -------
    root : ndarray (n, n)
        S at the start.
    gains : list of ndarray (m, n)
    """
    gains: list[Array] = []
    for (moves, push), (state, torque) in zip(reversed(pieces), reversed(weights), strict=True):
        size, inputs = push.shape
        # QR of the stacked roots: R = [[R_uu, R_ue], [0, S]], the gain is R_uu^-1 R_ue and S the new root.
        stacked = np.vstack(
            [
                np.hstack([torque, np.zeros((len(torque), size))]),
                np.hstack([root @ push, root @ moves]),
                np.hstack([np.zeros((size, inputs)), np.diag(state)]),
            ]
        )
        factor = np.asarray(np.linalg.qr(stacked, mode="r"), dtype=float)
        gains.append(np.linalg.solve(factor[:inputs, :inputs], factor[:inputs, inputs:]))
        root = factor[inputs:, inputs:]
    return root, gains[::-1]
