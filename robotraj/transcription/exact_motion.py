"""Motions that obey their equations everywhere, not at collocation points alone.

A robot with a motor at every joint can follow any motion q(t): inverse dynamics gives the torques that it takes,

    tau(t) = RNEA(q(t), v(t), a(t)) + d(v(t)),    qdot = v,    vdot = a.

Collocation gives a polynomial v(t) of degree s whose rate is a(t). Its integral is q(t): at the knots it is what was
collocated, where the quadrature of the scheme is exact for degree s. No equation is left that could err between the
points, whatever the friction; what is left to look at are limits and costs of tau(t).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis, integrals, lobatto_sites
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.transcription.schemes.collocation import Collocation, Scheme

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

ROUNDING = 1e-12
"""Error of a quadrature of degree s that counts as none."""


def is_exact(phase: Phase, schemes: Sequence[Scheme]) -> bool:
    """Whether the plan of a phase is a motion whose torques follow from inverse dynamics at any time.

    It is for a robot with a fixed root, a motor at every joint, no contacts and torques that are no states. The control
    must have the scheme's own shape. The scheme must integrate polynomials of its state's degree exactly, which the
    trapezoidal rule does not.
    """
    body = phase.body
    if not isinstance(body, InverseRigidBody) or body.contacts or body.invariants:
        return False
    robot = body.robot
    if robot.root != "fixed" or not robot.nq == robot.nv == robot.nu:
        return False
    if {f"tau.{joint}" for joint in robot.actuated} & {state.name for state in phase.dae.states}:
        return False  # The objective made states of the torques: they are continuous, and so they are planned.
    return all(_integrates_its_state(scheme) for scheme in dict.fromkeys(schemes))


def with_integrated_speeds(values: Array, lengths: Array, joints: int) -> tuple[Array, Array]:
    """Replace the positions of intervals by the integral of their speeds.

    Parameters
    ----------
    values : ndarray (K, s + 1, nx)
        Of the state at Lobatto's sites; positions come first, then speeds.
    lengths : ndarray (K,)
        Of the intervals [s].
    joints : int

    Returns
    -------
    tuple of ndarray
        Sites (s + 2,) of a polynomial of one degree more, and the values there (K, s + 2, nx).
    """
    sites, finer = lobatto_sites(values.shape[1]), lobatto_sites(values.shape[1] + 1)
    raised = basis(sites, finer) @ values
    travelled = integrals(sites, finer) @ values[..., joints : 2 * joints]
    raised[..., :joints] = values[:, :1, :joints] + lengths[:, None, None] * travelled
    return finer, raised


def _integrates_its_state(scheme: Scheme) -> bool:
    if not isinstance(scheme, Collocation) or not np.array_equal(scheme.control_sites, scheme.nodes):
        return False
    degree = len(scheme.nodes)
    return bool(abs(scheme.weights @ scheme.nodes**degree - 1.0 / (degree + 1)) < ROUNDING)
