"""Motions that satisfy their equations at all times, not only at collocation points.

A robot with a motor at every joint can follow any motion q(t). Inverse dynamics gives the torques,

    tau(t) = RNEA(q(t), v(t), a(t)) + d(v(t)),    qdot = v,    vdot = a.

Collocation gives a polynomial v(t) of degree s whose rate is a(t). Its integral q(t) equals the collocated positions at
the knots if the quadrature of the scheme is exact for degree s. All equations then hold between the points, with any
friction. Limits and costs of tau(t) remain to be measured.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis, integrals, lobatto_sites
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.augmentation import free_of
from robotraj.problem.phase import Phase
from robotraj.transcription.schemes.collocation import Collocation, Scheme

ROUNDING = 1e-12
"""Largest error of an exact quadrature."""


def is_exact(phase: Phase, schemes: Sequence[Scheme]) -> bool:
    """Whether the plan of a phase is a motion whose torques follow from inverse dynamics at any time.

    The robot has a fixed root, a motor at every joint, no contacts, and controls that are not states. The control is
    the scheme's own polynomial. The scheme integrates polynomials of its state's degree exactly, unlike the trapezoidal
    rule. On a path (``dynamics.path_body``) s is the integral of s', and all joints follow from it.
    """
    body = free_of(phase.body)
    if not isinstance(body, InverseRigidBody) or body.contacts or body.invariants:
        return False
    robot = body.robot
    if robot.root != "fixed" or not robot.nq == robot.nv == robot.nu:
        return False
    lifted = bool({control.name for control in phase.body.controls} & {state.name for state in phase.dae.states})
    if phase.path is not None:
        return all(_integrates_path(scheme, lifted) for scheme in dict.fromkeys(schemes))
    # Where the objective made torques states, these are planned as continuous functions.
    return not lifted and all(_integrates_its_state(scheme) for scheme in dict.fromkeys(schemes))


def with_integrated_speeds(values: Array, lengths: Array, joints: int) -> tuple[Array, Array]:
    """Replace the positions of intervals by the integrals of their speeds.

    Parameters
    ----------
    values : ndarray (K, s + 1, nx)
        Values of the state at Lobatto sites; positions come first, then speeds.
    lengths : ndarray (K,)
        Lengths of the intervals [s].
    joints : int
        Number of positions.

    Returns
    -------
    tuple of ndarray
        Sites (s + 2,) of polynomials of one degree more, and the values there (K, s + 2, nx).
    """
    sites, finer = lobatto_sites(values.shape[1]), lobatto_sites(values.shape[1] + 1)
    raised = basis(sites, finer) @ values
    travelled = integrals(sites, finer) @ values[..., joints : 2 * joints]
    raised[..., :joints] = values[:, :1, :joints] + lengths[:, None, None] * travelled
    return finer, raised


def _integrates_path(scheme: Scheme, lifted: bool) -> bool:
    """Whether s'' is interpolated by the scheme without error, and s' integrated so; ``lifted`` if s'' is a state."""
    if not isinstance(scheme, Collocation):
        return False
    degree = len(scheme.control_sites) - 1 + lifted
    return degree < len(scheme.nodes) and _is_exact_for(scheme, degree + 1)


def _integrates_its_state(scheme: Scheme) -> bool:
    if not isinstance(scheme, Collocation) or not np.array_equal(scheme.control_sites, scheme.nodes):
        return False
    return _is_exact_for(scheme, len(scheme.nodes))


def _is_exact_for(scheme: Collocation, degree: int) -> bool:
    return bool(abs(scheme.weights @ scheme.nodes**degree - 1.0 / (degree + 1)) < ROUNDING)
